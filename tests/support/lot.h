// Many frames of a still scene, each by random numbers of its own, against the light that it should show.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

struct job;

enum { LOT_WIDTH_PX = 12, LOT_HEIGHT_PX = 9, LOT_VALUES = 3 * LOT_WIDTH_PX * LOT_HEIGHT_PX };

struct lot_scene {
    const char *media;   // of "scene.media"
    const char *lights;  // of "lights", each with a comma behind it; NULL: none
    const char *quality; // members of "quality"
    const char *background;
};

// Exits the test where the job is refused. The scene is a ball of radius 1 or less around the origin, seen from 4 m.
void lot_parse(struct job *job, const struct lot_scene *scene);

struct lot_errors {
    double bias;   // mean error over the mean light
    double sigmas; // the same over its standard error
    double
        chance; // of all values together: squared errors of the frames' mean over its variance, 1 where only chance is wrong
    double spread; // of one frame: root of the mean variance, over the mean light
};

// The light that the scene should show, by reference/.
void lot_find_truth(const struct lot_scene *scene, double truth[static LOT_VALUES]);
// Prints what it found.
struct lot_errors lot_measure(const struct lot_scene *scene, const double truth[static LOT_VALUES], int frames);
