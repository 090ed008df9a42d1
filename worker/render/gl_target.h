// The textures that a frame is rendered into, as one framebuffer, and how they are read back.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;
struct image;
struct pixel_layout;
struct pixel_planes;
struct ray_counts;

struct gl_target_params {
    const struct image *image; // borrowed for the call: the size, and which pictures there are
    const struct pixel_layout
        *layout; // borrowed for the call; NULL: a frame; else a list, and the size is its layout's
    int pass_count;
    bool has_paths;     // rays are reflected or refracted, and are counted
    bool has_signature; // of a list: what each pixel shows is read
};

enum { GL_TARGET_TEXTURE_COUNT = 5 };

// The zero value is empty.
struct gl_target {
    const struct gl_functions *gl; // borrowed; outlives us
    int width_px, height_px;
    bool has_transmittance, has_depth, has_paths, has_signature;
    int pass_count;
    unsigned framebuffer;
    // Colour RGBA32F, transmittance RGBA32F, depth R32F (RG32F where there are several passes), paths RGBA32F,
    // signature R32UI; 0 where absent. For the largest picture each RGBA32F texture takes 1 GiB.
    unsigned textures[GL_TARGET_TEXTURE_COUNT];
    float *depth_sums; // owned; 2 a pixel: the sum of the depths and their count; NULL where there is one pass
};

// The fragment shader's outputs: 0 RGBA, 1 transmittance, 2 depth and 1 or 0 for whether there is one, 3 counts of the
// pixel's rays, as ray_counts_add_row reads them, 4 the pixel's signature (shaders/camera/pixel.glsl). Several passes
// are added up; the signature is the last one's.
bool gl_target_init(struct gl_target *target, const struct gl_functions *gl, const struct gl_target_params *params,
                    struct error *error);
void gl_target_finish(struct gl_target *target); // accepts an empty one
bool gl_target_fits(const struct gl_target *target, const struct gl_target_params *params);
// Makes the whole target the place to draw to, and clears it where passes are added up.
void gl_target_begin(const struct gl_target *target);
void gl_target_clear(const struct gl_target *target); // after gl_target_begin
// Copies the RGBA of some rows, 4 floats a pixel: the sum of the passes so far.
void gl_target_read_rows(const struct gl_target *target, int first_row, int row_count, float *rgba);
// Waits for the passes and copies their mean into `image`, which fits. A pixel's depth is the mean of those passes that
// found one. `counts` stays as it is where there are no paths; its share is not set. A list's image has as many pixels
// as the list, in its order, whatever its sides.
void gl_target_read(const struct gl_target *target, const struct pixel_layout *layout, struct image *image,
                    struct ray_counts *counts);
// Copies what a list that has signatures shows, in its order: means as above, also of the passes' paths.
void gl_target_read_planes(const struct gl_target *target, const struct pixel_layout *layout,
                           struct pixel_planes *planes);
