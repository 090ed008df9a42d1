// A medium in the integrator's terms: coefficients times a density field.
#pragma once

#include "core/scene.h"
#include "reference/span_list.h"
#include "reference/vec3.h"

struct density {
    const void *field;                                     // borrowed; outlives us
    double (*at)(const void *field, struct vec3 position); // >= 0
    // The same where a span's image says the position is; NULL when spans have no images. It saves the folding.
    double (*at_image)(const void *field, struct vec3 image);
    // Appends the stretches between `near` and `far` (which may be infinite) outside of which the density is zero. Ends
    // must lie where it jumps and belong where it is not smooth: a missing one costs time there.
    void (*spans)(const void *field, const struct ray *ray, double near, double far, struct span_list *spans);
};

struct medium_lobe {
    double g, weight;
};

struct medium {
    struct density density;
    double sigma_s[3], sigma_a[3];              // per metre and unit of density
    double emission[3];                         // source per metre and unit of density
    struct medium_lobe lobes[SCENE_LOBE_LIMIT]; // none: isotropic
    size_t lobe_count;
};

// Per steradian; `cos_theta` between the directions of travel before and after.
double medium_phase(const struct medium *medium, double cos_theta);
