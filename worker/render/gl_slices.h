// The state that pixels keep from slice to slice of their marches, in images that the program reads and writes.
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
// Binds and clears the images for a picture of that size. GL reports it when there is no memory.
void gl_slices_begin(struct gl_slices *slices, const struct gl_functions *gl, int width_px, int height_px);
// What is drawn between these two is one slice. The second waits for it and returns how many pixels it finished.
void gl_slices_open(const struct gl_slices *slices);
uint64_t gl_slices_close(const struct gl_slices *slices);
