// Bounds of a medium's density by brick, and the distances at which a ray may collide below them.
// SPDX-License-Identifier: Apache-2.0
// Tentative collisions of a density's bound are a Poisson process along the ray; which of them are real is the caller's
// draw. Woodcock et al., Techniques used in the GEM code, ANL-7050, 1965; bricks: Szirmay-Kalos, Toth and Magdics, Free
// Path Sampling in High Resolution Inhomogeneous Participating Media, Computer Graphics Forum 30, 2011.
#pragma once

#include "reference/density.h"

#include <stdbool.h>

struct majorant {
    const struct density *density; // borrowed; outlives us
    bool is_even;                  // wherever the density is positive it equals its bound
    double endless;                // the bound wherever clip leaves a ray, of an even density or one without an extent
    double most;                   // the greatest bound
    struct vec3 low;               // of the bricks' box
    double side[3];                // of a brick, m
    int count[3];                  // of bricks along each axis; 0: endless
    double *bricks;                // owned; bounds, x fastest; NULL: endless
};

// False when no bound of the density is known, or it is not finite. The density outlives the majorant. The caller
// passes it to majorant_finish in any case.
bool majorant_init(struct majorant *majorant, const struct density *density);
void majorant_finish(struct majorant *majorant); // accepts the zero value
// The bound at a position.
double majorant_at(const struct majorant *majorant, struct vec3 position);

// The way of a ray through the bricks.
struct flight {
    const struct majorant *majorant;
    double at, end, far;                        // m: here, the current brick's end, and the last brick's
    double most;                                // in the current brick
    double origin[3], direction[3], inverse[3]; // the last: 1 / direction
    double leave[3];                            // m to the current brick's end along each axis
    int brick[3], axis;                         // along which the next brick lies
};

// `far` may be INFINITY.
void flight_begin(struct flight *flight, const struct majorant *majorant, const struct ray *ray, double near,
                  double far);
// Goes on until the bound's integral has grown by `column`, and returns the distance from the ray's origin; INFINITY:
// the way ends before.
double flight_advance(struct flight *flight, double column);
// The bound's integral over what is left of the way; INFINITY where it has no end.
double flight_column(const struct flight *flight);
