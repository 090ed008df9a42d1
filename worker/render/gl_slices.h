// The state that pixels keep from slice to slice of their marches, in images that the program reads and writes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct gl_functions;

enum {
    GL_SLICES_MARCH_IMAGES = 3, // of a march
    GL_SLICES_WALK_IMAGES = 5   // of random paths
};

// The zero value is empty.
struct gl_slices {
    const struct gl_functions *gl; // borrowed; outlives us
    int width_px, height_px, image_count;
    unsigned images[GL_SLICES_WALK_IMAGES]; // RGBA32UI, at the units 0, 1, 2, 4 and 5: 16 bytes a pixel each
    unsigned query, count_buffer;
};

void gl_slices_finish(struct gl_slices *slices); // accepts an empty one
// Binds and clears `image_count` images for a picture of that size. GL reports it when there is no memory.
void gl_slices_begin(struct gl_slices *slices, const struct gl_functions *gl, int width_px, int height_px,
                     int image_count);
// What random paths did in a slice; nothing in slices of marches.
struct gl_slices_walked {
    double steps;  // that they took, about
    double pixels; // of whose paths so many are over, parts of them included
};

// What is drawn between these two is one slice. The second waits for it and returns how many pixels it finished.
void gl_slices_open(const struct gl_slices *slices);
uint64_t gl_slices_close(const struct gl_slices *slices, struct gl_slices_walked *walked);
