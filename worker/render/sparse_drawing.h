// Draws a frame of which some pixels are traced and the others interpolated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/picture/picture_level.h"

#include <stdbool.h>

struct drawing;
struct error;
struct gl_grids;
struct gl_target_params;
struct image;
struct job;
struct ray_counts;

struct sparse_drawing {
    struct drawing *drawing; // borrowed; its program is found and its files are bound
    const struct job *job;   // borrowed; its quality says which pixels
    struct gl_grids *grids;  // borrowed; the frame's are bound
    struct image *image;     // borrowed; of the job's size and channels
    int frame;
    bool has_paths;
    int thread_count;                 // of processors that draw
    picture_level_callback *on_level; // may be NULL
    void *user;
    double traced; // set: the share of the frame's samples that were traced
};

// Draws level after level. Counts of rays are set where there are paths; an interpolated pixel counts as its neighbours
// do. False with the drawing's fault.
bool sparse_drawing_run(struct sparse_drawing *sparse, struct ray_counts *counts, struct error *error);
