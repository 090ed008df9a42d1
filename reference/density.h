// The interface of density fields to the integrators.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/box.h"
#include "reference/span_list.h"
#include "reference/vec3.h"

#include <stdbool.h>

struct density {
    const void *field;                                     // borrowed; outlives us
    double (*at)(const void *field, struct vec3 position); // >= 0
    // The densities at several positions, each to the last bit that of at(); NULL: at() is called.
    void (*at_many)(const void *field, size_t count, const struct vec3 *positions, double *densities);
    // The density at a position of a span's image, which saves the folding; NULL when spans have no images.
    double (*at_image)(const void *field, struct vec3 image);
    // Appends the stretches between `near` and `far` outside of which the density is zero. An end must lie wherever the
    // density jumps, and should lie wherever it is not smooth: a missing one costs time. `far` may be infinite unless
    // the reach is.
    void (*spans)(const void *field, const struct ray *ray, double near, double far, struct span_list *spans);
    // The same, but stretches and ends may be missing that count no more than about `tolerance` in the integral of the
    // density; NULL: spans() is called.
    void (*rough_spans)(const void *field, const struct ray *ray, double near, double far, double tolerance,
                        struct span_list *spans);
    // The integral of the density in closed form, possibly INFINITY; NULL: it is integrated over the spans.
    double (*column)(const void *field, const struct ray *ray, double near, double far);
    // The distance along the ray beyond which the density is zero, possibly INFINITY; NULL: it is finite, and spans()
    // finds it.
    double (*reach)(const void *field, const struct ray *ray);
    // No density in the box is above it, rounding aside; NULL: no bound is known.
    double (*most)(const void *field, const struct box *box);
    // The density is zero outside the box that it writes; false, or NULL: there is no such box.
    bool (*extent)(const void *field, struct box *box);
    // Narrows the stretch of a ray to where the density may be positive; false: nowhere. NULL: it may be so everywhere.
    bool (*clip)(const void *field, const struct ray *ray, double *near, double *far);
};

static inline void density_at_many(const struct density *density, size_t count, const struct vec3 *positions,
                                   double *densities)
{
    if (density->at_many) {
        density->at_many(density->field, count, positions, densities);
        return;
    }
    for (size_t i = 0; i < count; i++)
        densities[i] = density->at(density->field, positions[i]);
}

static inline void density_rough_spans(const struct density *density, const struct ray *ray, double near, double far,
                                       double tolerance, struct span_list *spans)
{
    if (density->rough_spans) {
        density->rough_spans(density->field, ray, near, far, tolerance, spans);
    } else {
        density->spans(density->field, ray, near, far, spans);
    }
}
