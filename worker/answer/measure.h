// How long a picture takes in one setting of a method, and how it comes out.
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
    struct gl_timer *timer; // NULL: the time is what a clock on the wall says
    const struct job *job;
    int32_t frame;
    double limit_s;                // a rendering that takes longer is given up
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
// The same, then as often again as tells the median: whole frames, with all that is made for a frame made anew, once programs
// are linked and files read. A first rendering that takes long enough for that not to show counts itself.
enum measure_outcome measure_time(const struct measure_params *params, struct image *image, double *seconds,
                                  int *repeats, struct error *error);
