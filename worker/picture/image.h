// A rendered frame in memory: linear float pixels, first row on top.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct job;

enum { IMAGE_SIDE_LIMIT = 16384 }; // px

// The zero value is empty. Rows follow one another without padding.
struct image {
    int width_px, height_px;
    float *rgba;          // owned; 4 a pixel, premultiplied
    float *transmittance; // owned; 4 a pixel (R, G, B, unused); NULL when not asked for
    float *depth;         // owned; 1 a pixel, camera-space metres; NULL when not asked for
};

bool image_init(struct image *image, int width_px, int height_px, bool has_depth, bool has_transmittance,
                struct error *error); // contents undefined
// Of the size and channels of the job's frames.
bool image_init_for_job(struct image *image, const struct job *job, struct error *error);
void image_finish(struct image *image);
bool image_fits(const struct image *image, int width_px, int height_px, bool has_depth, bool has_transmittance);
// True if no value is NaN, infinite or, if `half`, over 65504 in size (depth apart: it is never written as half). Else
// `error` says how many there are of each and names the first with channel and pixel.
bool image_is_finite(const struct image *image, bool half, struct error *error);
