// The light that pixels of a frame should show: reference/ along the very rays and at the very moments that the renderer takes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/integrate.h"
#include "reference/still.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct job;
struct truth;

// False when a density is the user's GLSL, which nothing but the shader can evaluate.
bool truth_has_twin(const struct job *job);

struct truth_params {
    const struct job *job; // borrowed; outlives the truth. Its size and samples are those of the frames to be measured
    int32_t frame;
    // Twins of densities in GLSL, by medium; borrowed; outlive the truth. NULL: none
    const struct still_function *functions;
};

// Reads the files that the frame reads. It is the exact light: rays are followed for 32 reflections and refractions, down to a
// throughput of 1e-6, whatever the job's max_depth and min_throughput cut. NULL on failure: a file, memory, or a density that
// has no twin.
struct truth *truth_open(const struct truth_params *params, struct error *error);
// Goes to another frame of the same job; files that stay as they are are not read again. On failure nothing can be measured
// until it succeeds.
bool truth_seek(struct truth *truth, int32_t frame, struct error *error);
void truth_close(struct truth *truth); // accepts NULL

struct truth_pixel {
    double rgb[3]; // the mean of the samples
    // Of each colour of a picture: its variance about the light, because rough surfaces' normals are drawn by lot. Those of the
    // reference are others than the renderer's, and `rgb` itself has `share` times this variance. 0 without rough surfaces.
    double variance[3], share;
    bool is_converged; // false when refinement ended before the accuracy was reached
};

// `accuracy` may be NULL. Any number of threads may measure at once.
struct truth_pixel truth_measure(const struct truth *truth, int x, int y, const struct integrate_accuracy *accuracy);

struct truth_point {
    int x, y; // px, from the top left
};

struct truth_many {
    const struct truth_point *points; // `count`
    struct truth_pixel *pixels;       // `count`; filled from the first on
    size_t count;
    const struct integrate_accuracy *accuracy; // may be NULL
    int thread_count;                          // 0: a thread for each core
    bool (*on_progress)(void *user); // NULL: none; called by the caller's thread after each of its pixels; false: stop
    void *user;
};

// Returns how many pixels were measured: all, unless it was stopped.
size_t truth_measure_many(const struct truth *truth, const struct truth_many *many);
