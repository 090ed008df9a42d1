// The folded fractal's density: radius - |fold^iterations(p)|, to a power.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/box.h"
#include "reference/span_list.h"
#include "reference/vec3.h"

struct density_fold_fractal {
    int iterations;
    double offset, radius; // m
    double exponent, scale;
    double cos_x, sin_x, cos_y, sin_y; // of the rotations about x and y in each iteration
};

struct density_fold_fractal_params {
    int iterations;
    double offset, radius, exponent, scale;
    double rotate_x_rad, rotate_y_rad;
};

void density_fold_fractal_init(struct density_fold_fractal *fractal, const struct density_fold_fractal_params *params);
double density_fold_fractal(const struct density_fold_fractal *fractal, struct vec3 position);
// Signed distance, negative inside. It is Lipschitz with constant 1.
double density_fold_fractal_distance(const struct density_fold_fractal *fractal, struct vec3 position);
// The density is zero farther from the origin than this.
double density_fold_fractal_bound(const struct density_fold_fractal *fractal);

// No density in the box is above it.
double density_fold_fractal_most(const struct density_fold_fractal *fractal, const struct box *box);

// The density of a point that the folds map to `image`.
double density_fold_fractal_folded(const struct density_fold_fractal *fractal, struct vec3 image);

// Appends the stretches between `near` and `far` (which may be infinite) where the density is positive, cut at every
// fold. Each fold is an isometry on either side of its plane: within a span the density is a smooth function of the
// distance, and the span's image is the folded ray.
void density_fold_fractal_spans(const struct density_fold_fractal *fractal, const struct ray *ray, double near,
                                double far, struct span_list *spans);
