// What is known of some pixels: of a list, or of a lattice, in its order.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The zero value is empty. All are owned; each is NULL where it is not wanted.
struct pixel_planes {
    float *rgba;          // 4 a pixel, premultiplied
    float *transmittance; // 4 a pixel: R, G, B, unused
    float *paths;         // 4 a pixel, as ray_counts_add_pixel takes them
    float *depth;         // 1 a pixel, m; 0: none
    // 1 a pixel: equal where pixels show the same media and surfaces. The lowest bit is set where a ray met extinction
    // (shaders/camera/pixel.glsl).
    uint32_t *signatures;
};

struct pixel_channels {
    bool has_transmittance, has_paths, has_depth;
};

static inline float pixel_planes_least(float a, float b)
{
    return a < b ? a : b;
}

static inline float pixel_planes_most(float a, float b)
{
    return a > b ? a : b;
}

// Contents are undefined. Ends the process where there is no memory.
void pixel_planes_init(struct pixel_planes *planes, struct pixel_channels channels, size_t count);
void pixel_planes_finish(struct pixel_planes *planes); // accepts empty ones
// True where four depths differ by more than a fiftieth of the smallest: nothing is interpolated between these.
static inline bool pixel_planes_are_apart(float a, float b, float c, float d)
{
    float low = pixel_planes_least(pixel_planes_least(a, b), pixel_planes_least(c, d));
    float high = pixel_planes_most(pixel_planes_most(a, b), pixel_planes_most(c, d));

    return !(high - low <= 0.02f * low);
}
// Copies pixel `from` of some planes to pixel `to` of others with the same channels, or without signatures.
void pixel_planes_copy(const struct pixel_planes *planes, size_t to, const struct pixel_planes *other, size_t from);
