// Compares many frames of a still scene, each with its own random numbers, with the true light.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

struct job;

enum {
    BIAS_CHECK_WIDTH_PX = 12,
    BIAS_CHECK_HEIGHT_PX = 9,
    BIAS_CHECK_VALUES = 3 * BIAS_CHECK_WIDTH_PX * BIAS_CHECK_HEIGHT_PX
};

struct bias_check_scene {
    const char *media;      // elements of "scene.media"
    const char *lights;     // elements of "lights", each with a comma behind it; NULL: none
    const char *quality;    // members of "quality"
    const char *background; // a value; NULL: 0.3; empty: none
    const char *objects;    // elements of "scene.objects"; NULL: none
    const char *orders;     // of scattering, a value; NULL: 1
    const double *noise;    // standard errors of the truth, which widen what chance explains; NULL: it is exact
};

// The scene is a ball of radius 1 or less around the origin, seen from 4 m. A refusal fails the test.
void bias_check_parse(struct job *job, const struct bias_check_scene *scene);

struct bias_check_errors {
    double bias;   // mean error over the mean light
    double sigmas; // `bias` over its standard error
    double chance; // squared errors of the frames' mean over its variance, all values together: about 1 without bias
    double spread; // root of a frame's mean variance, over the mean light
};

// The light that the scene should show, by reference/.
void bias_check_find_truth(const struct bias_check_scene *scene, double truth[static BIAS_CHECK_VALUES]);
// The same for any orders of scattering, by `count` random paths a pixel; `errors` has the standard errors of `truth`.
void bias_check_find_paths(const struct bias_check_scene *scene, long count, double truth[static BIAS_CHECK_VALUES],
                           double errors[static BIAS_CHECK_VALUES]);
// The same of any job of that size, whose light does not change but from frame to frame by chance.
void bias_check_find_job_paths(const struct job *job, long count, double truth[static BIAS_CHECK_VALUES],
                               double errors[static BIAS_CHECK_VALUES]);
// Renders `frames` frames, each as a list of its pixels where the job traces a part of them, compares them with `truth`
// and prints the errors.
struct bias_check_errors bias_check_measure(const struct bias_check_scene *scene,
                                            const double truth[static BIAS_CHECK_VALUES], int frames);
// The same of any job of that size; `noise` as in struct bias_check_scene.
struct bias_check_errors bias_check_measure_job(const struct job *job, const double truth[static BIAS_CHECK_VALUES],
                                                const double *noise, int frames);
