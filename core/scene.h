// What is in front of the camera and how light passes through it. Metres, seconds, radians; coefficients per metre.
#pragma once

#include "core/timeline.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    SCENE_LIGHT_LIMIT = 16,
    SCENE_MEDIUM_LIMIT = 8,
    SCENE_LOBE_LIMIT = 8,
    SCENE_ITERATION_LIMIT = 32 // of a fold fractal
};

// A pinhole camera: forward = target - position, right = normalize(cross(forward, up)), image y up.
struct scene_camera {
    struct timeline position, target, up; // m
    struct timeline fov;                  // vertical, degrees, (0, 180)
    double clip_near, clip_far; // distances along the ray between which media are gathered; far may be INFINITY
    bool mirror;                // flips image x
};

enum scene_light_kind { SCENE_LIGHT_POINT, SCENE_LIGHT_SUN };

enum scene_falloff {
    SCENE_FALLOFF_INVERSE_SQUARE, // intensity is W/sr
    SCENE_FALLOFF_NONE            // intensity is the irradiance everywhere, W/m^2
};

struct scene_light {
    enum scene_light_kind kind;
    enum scene_falloff falloff; // point only
    struct timeline intensity;  // 1 or 3 components, >= 0; of a sun: irradiance
    struct timeline position;   // point only
    struct timeline direction;  // sun only: the way its light travels, of any length but 0
};

enum scene_density_kind { SCENE_DENSITY_FOLD_FRACTAL };

// rho(p) = scale max(radius - |fold^iterations(p)|, 0)^exponent; see docs/job_format.md. 1-Lipschitz distance; zero outside
// |p| = radius + iterations sqrt(3) offset.
struct scene_fold_fractal {
    int iterations;                             // [1, SCENE_ITERATION_LIMIT]
    struct timeline offset, radius;             // m
    struct timeline rotate_x_rad, rotate_y_rad; // angle per iteration
    struct timeline exponent;                   // > 0
    struct timeline scale;                      // >= 0
};

struct scene_density {
    enum scene_density_kind kind;
    struct scene_fold_fractal fold_fractal;
};

// One Henyey-Greenstein lobe; weights of a medium's lobes are >= 0 and sum to 1 within 1e-6.
struct scene_phase_lobe {
    struct timeline g;      // [-0.99999, 0.99999], forward positive
    struct timeline weight; // [0, 1]
};

struct scene_medium {
    struct scene_density density;
    struct timeline sigma_s, sigma_a; // 1 or 3 components, >= 0, per metre and unit of density
    struct timeline emission;         // 1 or 3 components, >= 0: source per unit of density
    bool has_emission;
    struct scene_phase_lobe lobes[SCENE_LOBE_LIMIT]; // none: isotropic
    size_t lobe_count;
};

struct scene {
    struct scene_camera camera;
    struct scene_light lights[SCENE_LIGHT_LIMIT];
    size_t light_count;
    struct scene_medium media[SCENE_MEDIUM_LIMIT];
    size_t medium_count;
    struct timeline background; // radiance behind everything
    bool has_background;
};

void scene_finish(struct scene *scene);
// True when nothing in it changes with time.
bool scene_is_constant(const struct scene *scene);
