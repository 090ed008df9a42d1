// The light of all orders of scattering that a pixel should show, by random paths in double precision.
// SPDX-License-Identifier: Apache-2.0
// The means are unbiased and their errors known; two measurements with different seeds are independent halves.
#pragma once

#include "reference/still.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct paths;

struct paths_light {
    double mean[3];  // radiance, with what lies behind everything
    double error[3]; // standard errors of the means; 0 for a single path
    double looks;    // at densities along the ways, without those towards lamps
};

// Paths through a still, for any number of threads at once. Light of lamps and domes is scattered at most `orders`
// times (1 .. SCENE_ORDERS_ALL) by media and diffuse surfaces, emitted light once less. NULL with an error that says
// what paths cannot follow in the still: mirrors, dielectrics, specular surfaces, densities without a known bound,
// endless media that absorb nothing. The still outlives the paths.
struct paths *paths_create(const struct still *still, int orders, struct error *error);
void paths_destroy(struct paths *paths); // accepts NULL

// The light along the ray through the pixel's point (x, y), counted from the image's top left corner: (i + 0.5, j +
// 0.5) is the centre of pixel (i, j).
void paths_measure_point(const struct paths *paths, double x, double y, long count, uint64_t seed,
                         struct paths_light *light);
struct paths_parts_params {
    double x, y; // the point, as above
    int modelled;
    long count;
    uint64_t seed;
    double draws_most; // random numbers that may be drawn; 0: any number
};

// Light in two parts, of the same paths: what the two have in common has no noise in their difference.
struct paths_parts {
    double within[3]; // mean of what is scattered at most `modelled` times, with what lies behind everything
    double beyond[3]; // mean of the rest, scattered more often
    double draws;     // random numbers: each look at a density, towards lamps too, follows one of its own
};

// False when more than draws_most were drawn: the means are then worth nothing.
bool paths_measure_parts(const struct paths *paths, const struct paths_parts_params *params, struct paths_parts *parts);
// All of the light at a pixel's centre, the still being prepared for it alone; false when paths cannot follow it.
bool paths_measure_pixel(const struct still *still, int orders, int x, int y, long count, uint64_t seed,
                         struct paths_light *light);
