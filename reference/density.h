// The interface of density fields to the integrators.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/span_list.h"
#include "reference/vec3.h"

struct density {
    const void *field;                                     // borrowed; outlives us
    double (*at)(const void *field, struct vec3 position); // >= 0
    // The density at a position of a span's image, which saves the folding; NULL when spans have no images.
    double (*at_image)(const void *field, struct vec3 image);
    // Appends the stretches between `near` and `far` outside of which the density is zero. An end must lie wherever the
    // density jumps, and should lie wherever it is not smooth: a missing one costs time. `far` may be infinite unless
    // the reach is.
    void (*spans)(const void *field, const struct ray *ray, double near, double far, struct span_list *spans);
    // The integral of the density in closed form, possibly INFINITY; NULL: it is integrated over the spans.
    double (*column)(const void *field, const struct ray *ray, double near, double far);
    // The distance along the ray beyond which the density is zero, possibly INFINITY; NULL: it is finite, and spans()
    // finds it.
    double (*reach)(const void *field, const struct ray *ray);
};
