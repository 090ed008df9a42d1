// A frame that is to be rendered, and what is told of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/picture/picture_level.h"
#include "worker/picture/ray_counts.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct image;
struct pixel;

// Called between tiles with the share done in [0, 1]; false stops the frame.
typedef bool renderer_progress(void *user, double done);

struct renderer_result {
    enum renderer_fault fault;
    double seconds;                               // GPU work and readback
    int64_t cache_fills;                          // caches that it filled; the others were up to date
    double walks;                                 // random walks that these took from nodes of a grid
    double steps;                                 // of these walks, or of a list's random paths
    bool is_copy;                                 // not rendered: the frame before has the same inputs
    const char *shader_hash;                      // borrowed from the renderer until the next call
    char picture_hash[HASH_TEXT_SIZE];            // as renderer_hash_picture makes it
    double step;                                  // m, along camera rays
    double traced;                                // share of the frame's samples that were traced; 1 for lists
    double noise;                                 // of random paths, relative RMSE, where layers know it; else 0
    struct ray_counts ray_counts;                 // also set for a copy
    double world_to_camera[16], world_to_ndc[16]; // as image_exr_header has them
};

// Whose random numbers paths follow: a plan that drew the picture's own would choose numbers by the picture's luck. The
// difference of a plan's two pictures tells their noise.
enum renderer_stream { RENDERER_STREAM_PICTURE, RENDERER_STREAM_PLAN, RENDERER_STREAM_PLAN_AGAIN };

// A frame to render, or some of its pixels. All that it points to is borrowed for the call.
struct renderer_frame {
    const struct job *job;
    int32_t frame;
    enum renderer_stream stream;
    // The pixels of a list, in any order, each as it is in the whole frame; NULL: all.
    const struct pixel *pixels;
    size_t pixel_count;
    // Initialised with the channels of the job. It has the job's size, or as many pixels as the list, which it gets in
    // the list's order: width_px * height_px is pixel_count.
    struct image *image;
    renderer_progress *on_progress;   // may be NULL
    picture_level_callback *on_level; // may be NULL; called with each level of a frame whose pixels are sparse
    void *user;
};
