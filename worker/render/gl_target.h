// The textures a frame is rendered into, as one framebuffer, and how they come back.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;
struct image;
struct ray_counts;

struct gl_target_params {
    const struct image *image; // borrowed for the call: the size, and which pictures there are
    int pass_count;
    bool has_paths; // rays are reflected or refracted, and counted
};

// The zero value is empty.
struct gl_target {
    const struct gl_functions *gl; // borrowed; outlives us
    int width_px, height_px;
    bool has_transmittance, has_depth, has_paths;
    int pass_count;
    unsigned framebuffer;
    // RGBA32F, transmittance RGBA32F, depth R32F or, of several passes, RG32F, paths RGBA32F; 0 where absent. Those of four
    // floats take 1 GiB each of the largest picture.
    unsigned textures[4];
    float *depth_sums; // owned; 2 a pixel: the sum of the depths and their count; NULL where there is one pass
};

// The fragment outputs that match: 0 RGBA, 1 transmittance, 2 depth and whether there is one (1 or 0), 3 what became of
// the pixel's rays, as ray_counts_add_row reads it. Several passes are added up.
bool gl_target_init(struct gl_target *target, const struct gl_functions *gl, const struct gl_target_params *params,
                    struct error *error);
void gl_target_finish(struct gl_target *target); // accepts an empty one
bool gl_target_fits(const struct gl_target *target, const struct gl_target_params *params);
// Makes it what is drawn to, all of it, and empties it where passes are added up.
void gl_target_begin(const struct gl_target *target);
void gl_target_clear(const struct gl_target *target); // once it has begun
// Copies the RGBA of some rows as it is by now, the sum of the passes so far, 4 floats a pixel.
void gl_target_read_rows(const struct gl_target *target, int first_row, int row_count, float *rgba);
// Copies the mean of the passes into `image`, which fits; waits until they are rendered. A pixel's depth is the mean of
// those passes that found one. `counts` is left as it is where there are no paths, and gets no share.
void gl_target_read(const struct gl_target *target, struct image *image, struct ray_counts *counts);
