// A medium in the integrator's terms: coefficients times a density field.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"
#include "reference/density.h"
#include "reference/vec3.h"

struct medium_lobe {
    enum scene_lobe_kind kind;
    double g; // Henyey-Greenstein only
    double weight;
};

// Source per metre and unit of density that varies with position. The zero value is none.
struct medium_glow {
    const void *field; // borrowed; outlives us
    void (*at)(const void *field, struct vec3 position, double source[static 3]);
    // Splits spans where the glow is not smooth; NULL: it is smooth wherever the density is.
    void (*split)(const void *field, const struct ray *ray, struct span_list *spans);
};

struct medium {
    struct density density;
    double sigma_s[3], sigma_a[3];              // per metre and unit of density
    double emission[3];                         // source per metre and unit of density
    struct medium_glow glow;                    // added to the emission
    struct medium_lobe lobes[SCENE_LOBE_LIMIT]; // none: isotropic
    size_t lobe_count;
    size_t region; // see reference/objects.h; 0: the air
};

// Per steradian; `cos_theta` between the directions of travel before and after.
double medium_phase(const struct medium *medium, double cos_theta);
// Source per metre at a position where the density is `density`, without scattered light.
void medium_source(const struct medium *medium, struct vec3 position, double density, double source[static 3]);
