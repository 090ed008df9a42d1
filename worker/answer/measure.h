// Renders a picture with one setting of a method and measures how long that takes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct gl_timer;
struct image;
struct renderer;

struct measure_params {
    struct renderer *renderer;
    struct gl_timer *timer; // NULL: wall time counts
    const struct job *job;
    int32_t frame;
    double limit_s;                // a rendering that takes longer is stopped
    bool (*is_wanted)(void *user); // NULL: always
    void *user;
};

enum measure_outcome {
    MEASURE_DONE,
    MEASURE_REFUSED, // `error` says why
    MEASURE_TOO_SLOW,
    MEASURE_UNWANTED
};

// Renders the frame once. `image` is of the job's size and channels.
enum measure_outcome measure_render(const struct measure_params *params, struct image *image, double *seconds,
                                    struct error *error);
// Renders the frame once, then repeatedly, and gives the median of the repeats' seconds. Programs are then linked and
// files read, but everything that is made for a frame is made anew each time. A first rendering that takes so long that
// linking and reading hardly count is the only one.
enum measure_outcome measure_time(const struct measure_params *params, struct image *image, double *seconds,
                                  int *repeats, struct error *error);
