// What the integrators ask of a field of density.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/span_list.h"
#include "reference/vec3.h"

struct density {
    const void *field;                                     // borrowed; outlives us
    double (*at)(const void *field, struct vec3 position); // >= 0
    // The same where a span's image says the position is; NULL when spans have no images. It saves the folding.
    double (*at_image)(const void *field, struct vec3 image);
    // Appends the stretches between `near` and `far` outside of which the density is zero. Ends must lie where it jumps and
    // belong where it is not smooth: a missing one costs time there. `far` may be infinite unless the reach is.
    void (*spans)(const void *field, const struct ray *ray, double near, double far, struct span_list *spans);
    // The integral of the density in closed form, maybe INFINITY; NULL: it is integrated over the spans.
    double (*column)(const void *field, const struct ray *ray, double near, double far);
    // Where along the ray the density ends, INFINITY: nowhere; NULL: somewhere, and spans() finds it.
    double (*reach)(const void *field, const struct ray *ray);
};
