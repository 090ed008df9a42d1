// The textures a frame is rendered into, as one framebuffer, and how they come back.
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;
struct image;

// The zero value is empty.
struct gl_target {
    const struct gl_functions *gl; // borrowed; outlives us
    int width_px, height_px;
    bool has_transmittance, has_depth;
    unsigned framebuffer;
    unsigned textures[3]; // RGBA32F, transmittance RGBA32F, depth R32F; 0 where absent
};

// The fragment outputs that match: 0 RGBA, 1 transmittance, 2 depth.
bool gl_target_init(struct gl_target *target, const struct gl_functions *gl, const struct image *image,
                    struct error *error);
void gl_target_finish(struct gl_target *target); // accepts an empty one
bool gl_target_fits(const struct gl_target *target, const struct image *image);
// Copies all pixels into `image`, which fits; waits until they are rendered.
void gl_target_read(const struct gl_target *target, struct image *image);
