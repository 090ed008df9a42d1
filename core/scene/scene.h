// What is in front of the camera and how light passes through it. Metres, seconds, radians; coefficients per metre.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/density.h"
#include "core/scene/timeline.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SCENE_LIGHT_LIMIT = 16,
    SCENE_MEDIUM_LIMIT = 8, // interiors among them
    SCENE_LOBE_LIMIT = 8,
    SCENE_OBJECT_LIMIT = 16,
    SCENE_SHAPE_LIMIT = 32 // of all objects
};

// A pinhole camera: forward = target - position, right = normalize(cross(forward, up)), image y up.
struct scene_camera {
    struct timeline position, target, up; // m
    struct timeline fov;                  // vertical, degrees, (0, 180)
    double clip_near, clip_far; // distances along the ray between which media are gathered; far may be INFINITY
    bool mirror;                // flips image x
    double shutter;             // open from t to t + shutter / fps; [0, 1000]
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

// Light of a hot grid: source = intensity rho B(kelvin value), B being Planck's light in linear Rec. 709, scaled to the
// luminance 1 at 1500 K.
struct scene_blackbody {
    char *grid_name;           // owned; in the density's own NanoVDB file; NULL: there is none
    struct timeline kelvin;    // per unit of the grid's value
    struct timeline intensity; // >= 0
};

enum scene_lobe_kind { SCENE_LOBE_HENYEY_GREENSTEIN, SCENE_LOBE_RAYLEIGH };

// Weights of a medium's lobes are >= 0 and sum to 1 within 1e-6.
struct scene_phase_lobe {
    enum scene_lobe_kind kind;
    struct timeline g;      // Henyey-Greenstein: [-0.99999, 0.99999], forward positive
    struct timeline weight; // [0, 1]
};

struct scene_medium {
    struct scene_density density;
    struct timeline sigma_s, sigma_a; // 1 or 3 components, >= 0, per metre and unit of density
    struct timeline emission;         // 1 or 3 components, >= 0: source per unit of density
    bool has_emission;
    struct scene_blackbody blackbody;
    struct scene_phase_lobe lobes[SCENE_LOBE_LIMIT]; // none: isotropic
    size_t lobe_count;
    size_t owner; // 1 + the index of the object that it fills; 0: what is outside of all dielectric objects
};

enum scene_shape_kind { SCENE_SHAPE_SPHERE, SCENE_SHAPE_BOX, SCENE_SHAPE_PLANE };

// A convex solid; of a plane: all that lies behind it, where its normal does not point.
struct scene_shape {
    enum scene_shape_kind kind;
    struct timeline center; // m; of a plane: any of its points
    struct timeline radius; // of a sphere, m
    struct timeline size;   // of a box: its sides along the world's axes, m
    struct timeline normal; // of a plane, of any length but 0
};

// An image on a surface, which it covers in tiles. On a plane and on a box's face seen from outside, its first row on
// top: the image's middle lies at the shape's `center` or the face's middle, to its right is s = normalize(cross(a, n)), up is
// cross(n, s), n being the face's normal and a the world's y axis, or, where |n.y| > 0.999, -z. Around a sphere it goes
// once: u = 1/2 + atan2(x, z) / 2 pi from left to right, v = 1/2 + asin(y) / pi up, (x, y, z) being the normal.
struct scene_texture {
    char *file;      // owned; PNG or EXR; NULL: there is none
    double size[2];  // m of a tile, across and up; an `up` of 0: as the image's sides are; not used on spheres
    bool is_nearest; // else bilinear
    bool is_linear;  // values are as the file has them; else sRGB, decoded before filtering
};

enum scene_material_kind { SCENE_MATERIAL_DIFFUSE, SCENE_MATERIAL_MIRROR, SCENE_MATERIAL_DIELECTRIC };

// Which share F of light a smooth boundary reflects. Whatever it is, F = 1 beyond the critical angle.
enum scene_fresnel {
    SCENE_FRESNEL_EXACT,   // of unpolarised light, by `ior`
    SCENE_FRESNEL_SCHLICK, // f0 + (f90 - f0) (1 - c)^5, c the cosine on the side of the smaller ior
    SCENE_FRESNEL_NONE     // of a dielectric 0; of a diffuse material's specular share 1
};

struct scene_material {
    enum scene_material_kind kind;
    struct timeline albedo;       // of diffuse: 1 or 3 components, [0, 1]; times the texture's where there is one
    struct scene_texture texture; // of diffuse
    struct timeline specular; // of diffuse, [0, 1]: F times this is reflected as by a mirror, the rest meets the albedo
    struct timeline reflectance; // of a mirror: 1 or 3 components, [0, 1]
    enum scene_fresnel fresnel;  // of dielectric, and of diffuse with a specular share
    struct timeline ior;         // of the same, [0.1, 10]
    struct timeline f0, f90;     // of Schlick's, [0, 1]
    bool has_f0;                 // else ((ior - 1) / (ior + 1))^2, ior relative to the other side
    struct timeline roughness;   // of all that reflects or refracts, [0, 1]: normal + roughness * unit-sphere vector
};

// A solid: the union of its shapes. Where objects overlap, the later one is there alone.
struct scene_object {
    size_t first_shape, shape_count; // in the scene's
    bool is_union;                   // as the job has it
    struct scene_material material;
};

struct scene {
    struct scene_camera camera;
    struct scene_light lights[SCENE_LIGHT_LIMIT];
    size_t light_count;
    struct scene_medium media[SCENE_MEDIUM_LIMIT];
    size_t medium_count;
    struct scene_shape shapes[SCENE_SHAPE_LIMIT];
    size_t shape_count;
    struct scene_object objects[SCENE_OBJECT_LIMIT];
    size_t object_count;
    struct timeline background; // radiance behind everything
    bool has_background;
};

void scene_finish(struct scene *scene);
// True when nothing in it changes with time.
bool scene_is_constant(const struct scene *scene);
// True when it may differ from frame to frame whatever its numbers do: a file a frame, or code that is given the time.
bool scene_density_is_sequence(const struct scene_density *density);
// True when it is the same everywhere inside its bounds at any one time: homogeneous without falloff.
bool scene_density_is_even(const struct scene_density *density);

// The place of a medium in the job's document, "scene.media[0]" or "scene.objects[2].material.interior"; of `size` bytes.
void scene_format_medium_place(const struct scene *scene, size_t medium, char *place, size_t size);

// The name of the first text by the user that a density follows; NULL: there is none.
const char *scene_find_code(const struct scene *scene);

// Visits each number or vector that may move, always in the same order; `name` is short and not unique.
void scene_visit_timelines(struct scene *scene, timeline_visitor *visit, void *user);
