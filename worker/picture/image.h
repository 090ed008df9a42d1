// A rendered frame in memory: linear float pixels, top row first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct job;

enum { IMAGE_SIDE_LIMIT = 16384 }; // px

// The zero value is empty. Rows follow one another without padding.
struct image {
    int width_px, height_px;
    float *rgba;          // owned; 4 a pixel, premultiplied
    float *transmittance; // owned; 4 a pixel (R, G, B, unused); NULL when not asked for
    float *depth;         // owned; 1 a pixel, camera-space metres; NULL when not asked for
    // Owned; 1 a pixel: the summed throughput of its cut rays, per sample (ray_counts.h). NULL when not asked for; no
    // file has it.
    float *cut;
    // Owned; 1 a pixel: 0 where it was traced, else how doubtful its interpolation was, 255 as much as was allowed.
    // NULL where every pixel was traced; no file has it.
    uint8_t *doubts;
};

bool image_init(struct image *image, int width_px, int height_px, bool has_depth, bool has_transmittance,
                struct error *error); // contents undefined
// Makes an image with the size and channels of the job's frames.
bool image_init_for_job(struct image *image, const struct job *job, struct error *error);
// Asks for `cut`, whose contents are undefined.
bool image_ask_cut(struct image *image, struct error *error);
void image_finish(struct image *image);
// Copies size, channels and values, without `cut` and `doubts`. `to` is empty or has size and channels of `from`.
bool image_copy(struct image *to, const struct image *from, struct error *error);
bool image_fits(const struct image *image, int width_px, int height_px, bool has_depth, bool has_transmittance);
// Returns true if no value is NaN, infinite or, with `half`, over 65504 in magnitude (except depth, which is never
// written as half). Else `error` has the number of each and names the first by channel and pixel.
bool image_is_finite(const struct image *image, bool half, struct error *error);
// The same of some rows, without a reason.
bool image_rows_are_finite(const struct image *image, bool half, int first_row, int row_count);

// The bits of a pixel's values; 0 in channels that the image does not have.
struct image_pixel {
    uint32_t rgba[4], transmittance[4], depth;
};

// Returns true if all pixels of some rows are the same, to the bit. `pixel` is the first of them then.
bool image_rows_are_constant(const struct image *image, int first_row, int row_count, struct image_pixel *pixel);
