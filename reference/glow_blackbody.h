// Emission of a hot medium: a black body at a grid's temperatures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/grid.h"
#include "reference/medium.h"

enum { GLOW_BLACKBODY_NODES = 24 };

struct glow_blackbody {
    struct grid grid;
    double kelvin;    // per unit of the grid's value
    double intensity; // glow = intensity B(kelvin value)
    // The logarithms of B's tristimulus values as functions of 1 / temperature, at Chebyshev's nodes: they are nearly
    // linear.
    double coldness_low, coldness_high; // 1 / K
    double log_xyz[GLOW_BLACKBODY_NODES][3];
};

struct glow_blackbody_params {
    struct grid_params grid;
    double kelvin, intensity;
};

void glow_blackbody_init(struct glow_blackbody *field, const struct glow_blackbody_params *params);
struct medium_glow glow_blackbody(const struct glow_blackbody *field); // borrows the field
