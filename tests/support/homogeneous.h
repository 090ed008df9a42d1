// Media of constant density, whose light is known in closed form.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/medium.h"

// Density 1 inside, centred on the origin. The functions borrow their arguments.
struct homogeneous_sphere {
    double radius; // m
};

struct homogeneous_box {
    double half_x, half_y, half_z; // m; INFINITY makes a slab of it
};

struct density homogeneous_sphere_density(const struct homogeneous_sphere *sphere);
struct density homogeneous_box_density(const struct homogeneous_box *box);
