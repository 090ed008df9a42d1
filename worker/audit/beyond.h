// Measures how much of a job's light its modelled orders of scattering leave out, by whole paths in reference/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job_beyond.h"

#include <stdbool.h>
#include <stdint.h>

struct job;
struct still_inputs;

struct beyond_params {
    const struct job *job;
    // That stand for all; only the middle one is looked at where a file belongs to one frame each, and where the draws
    // do not allow more.
    const int32_t *frames;
    int frame_count; // >= 1
    // Files of the middle one, read already; NULL: they are read, which counts as draws.
    const struct still_inputs *inputs;
    uint64_t seed;                   // other numbers draw other paths; plans have 0
    double draws_most;               // random numbers that may be drawn: looks at densities, and a few more
    bool (*on_progress)(void *user); // may be NULL; called after each pixel; false: stop
    void *user;
};

// True where paths tell: some order is not modelled, something scatters, and paths can follow the scene's surfaces and
// densities. Else `beyond` says why not, or that nothing is left out. Reads no files: what needs its file may yet
// be refused by beyond_measure.
bool beyond_needs_paths(const struct job *job, int32_t frame, struct job_beyond *beyond);

// Both pictures, that of the modelled orders and that of all, are those of the same paths, with one sample a pixel in
// the middle of the shutter's time: the light that is left out is their difference. It is measured twice, by 8 to 64
// paths, in each of 64 to 1024 pixels that lie evenly in the picture. Both numbers follow from what some other paths
// cost. Equal parameters give equal results. `drawn` (may be NULL) receives the random numbers that were drawn, and
// those that would take as long as reading files. False when it was stopped. What cannot be
// measured says why: surfaces and densities that paths cannot follow, files that cannot be read, black frames, too few
// draws.
bool beyond_measure(const struct beyond_params *params, struct job_beyond *beyond, double *drawn);
