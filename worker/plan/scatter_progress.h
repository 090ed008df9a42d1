// How much of a plan of several orders of scattering is made: its light, and its pictures by random paths.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct plan_params;
struct truth_pixel;

// Begins with its params; all else is zero.
struct scatter_progress {
    const struct plan_params *params; // borrowed
    double begun, part;               // of the time for the light: what was measured before, and what is being measured
    const struct truth_pixel *pixels; // of that part, with a rough light. Borrowed; NULL: none are known
    size_t count;
    double done; // of that part: truth_measure_many notes it
    int picture_count;
};

// What is measured next is that share of the time for the light. Pixels that have been found dark take none of it.
void scatter_progress_begin_light(struct scatter_progress *progress, double share, const struct truth_pixel *pixels,
                                  size_t count);
// A callback of truth_measure_many, with the progress for `user`.
bool scatter_progress_on_pixel(void *user);
void scatter_progress_count_picture(struct scatter_progress *progress);
