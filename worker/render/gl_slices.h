// What the pixels of a picture keep from slice to slice of their marches, in images that its program reads and writes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct gl_functions;

enum { GL_SLICES_IMAGE_COUNT = 3 };

// The zero value is empty.
struct gl_slices {
    const struct gl_functions *gl; // borrowed; outlives us
    int width_px, height_px;
    unsigned images[GL_SLICES_IMAGE_COUNT]; // RGBA32UI, at the units of the same number: 48 bytes a pixel
    unsigned query;
};

void gl_slices_finish(struct gl_slices *slices); // accepts an empty one
// Binds the images of a picture of that size; no pixel has begun. GL tells when there is no memory.
void gl_slices_begin(struct gl_slices *slices, const struct gl_functions *gl, int width_px, int height_px);
// Draws one slice of what the scissors leave of the full screen, and waits for it. Returns how many pixels became done.
uint64_t gl_slices_draw(const struct gl_slices *slices);
