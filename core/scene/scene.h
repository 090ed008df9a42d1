// The scene: camera, lights, media and objects. Metres, seconds, radians; coefficients per metre.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/density.h"
#include "core/scene/timeline.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SCENE_LIGHT_LIMIT = 16,
    SCENE_MEDIUM_LIMIT = 8, // including interiors
    SCENE_LOBE_LIMIT = 8,
    SCENE_OBJECT_LIMIT = 16,
    SCENE_SHAPE_LIMIT = 32, // of all objects
    SCENE_ORDER_LIMIT = 1000,
    SCENE_ORDERS_ALL = 1000 * 1000, // stands for every order of scattering
    SCENE_ORDERS_SIZE = 16,         // bytes of their text
    SCENE_IMAGE_RADIANCE_LIMIT = 1000 * 1000 * 1000
};

// A pinhole camera: forward = target - position, right = normalize(cross(forward, up)), image y up.
struct scene_camera {
    struct timeline position, target, up; // m
    struct timeline fov;                  // vertical, degrees, (0, 180)
    double clip_near, clip_far;           // distances along the ray between which media count; far may be INFINITY
    bool mirror;                          // flips image x
    double shutter;                       // frames: open from t to t + shutter / fps; [0, 1000]
};

// An image that covers a surface in tiles, its first row on top. On a plane, and on a box's face seen from outside, the
// image's middle lies at the shape's `center` or the face's middle. Right is s = normalize(cross(a, n)), up is cross(n,
// s), with the face's normal n and a = the world's y axis, or -z where |n.y| > 0.999. Around a sphere the image goes
// once: u = 1/2 + atan2(x, z) / 2 pi from left to right, v = 1/2 + asin(y) / pi up, with the normal (x, y, z).
struct scene_texture {
    char *file;       // owned; PNG or EXR; NULL: there is none
    double size[2];   // of a tile, m, across and up; an `up` of 0 follows from the image's aspect; unused on spheres
    bool is_nearest;  // else bilinear
    bool is_linear;   // values are linear; else sRGB, decoded before filtering
    bool is_radiance; // of a dome, and only of one: values to SCENE_IMAGE_RADIANCE_LIMIT, else to 1
};

enum scene_light_kind {
    SCENE_LIGHT_POINT,
    SCENE_LIGHT_SUN,
    SCENE_LIGHT_SPOT,   // a point that shines into a cone
    SCENE_LIGHT_SPHERE, // of even radiance outside, dark inside; it blocks nothing
    SCENE_LIGHT_DOME    // light from all directions, infinitely far away; a scene has one at most
};

enum scene_falloff {
    SCENE_FALLOFF_INVERSE_SQUARE, // intensity is W/sr
    SCENE_FALLOFF_NONE            // intensity is the irradiance everywhere, W/m^2
};

enum scene_dome_kind {
    SCENE_DOME_RADIANCE, // the same from everywhere
    SCENE_DOME_GRADIENT, // from `opposite` against the axis to `intensity` along it, linear in the cosine
    SCENE_DOME_FILE      // an image of all directions
};

// An image in latitude and longitude, as OpenEXR's environment maps are: u = 1/2 - atan2(x, z) / 2 pi from left to
// right, v = 1/2 + asin(y) / pi up, of the direction (x, y, z) towards the sky, so that who looks at it from inside
// does not see it mirrored. Then it is turned by `angle` about `axis`.
struct scene_dome {
    enum scene_dome_kind kind;
    struct scene_texture image; // file: an EXR, bilinear; else its file is NULL
    struct timeline opposite;   // gradient: radiance, 1 or 3 components, >= 0
    struct timeline axis;       // gradient, file; any length but 0
    struct timeline angle;      // file, degrees
    bool is_visible;            // it is seen behind everything
};

struct scene_light {
    enum scene_light_kind kind;
    enum scene_falloff falloff; // point only
    // 1 or 3 components, >= 0: W/sr; of a sun: irradiance; of a dome: radiance, that of the gradient along its axis, or
    // by what the image is multiplied. A sphere's radiance is intensity / (pi radius^2), W/sr seen from afar.
    struct timeline intensity;
    struct timeline position;     // where its kind has one (light_rules.h)
    struct timeline direction;    // the same: the direction of travel of its light; any length but 0
    struct timeline inner, outer; // spot: half-angles in degrees, of all of its light, [0, 90], and none, (0, 90];
                                  // smoothstep between; inner <= outer
    struct timeline radius;       // sphere: m, > 0
    struct scene_dome dome;       // dome
};

// Blackbody emission: source = intensity rho B(kelvin value). B is Planck's radiation in linear Rec. 709, scaled to the
// luminance 1 at 1500 K.
struct scene_blackbody {
    char *grid_name;           // owned; of temperature, in the density's NanoVDB file; NULL: no blackbody
    struct timeline kelvin;    // K per unit of the grid's value
    struct timeline intensity; // >= 0
};

enum scene_lobe_kind { SCENE_LOBE_HENYEY_GREENSTEIN, SCENE_LOBE_RAYLEIGH };

// The weights of a medium's lobes are >= 0 and sum to 1 within 1e-6.
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
    size_t owner; // 1 + the index of the object that it fills; 0: it lies outside of all dielectric objects
};

enum scene_shape_kind { SCENE_SHAPE_SPHERE, SCENE_SHAPE_BOX, SCENE_SHAPE_PLANE };

// A convex solid. A plane is the half-space behind it, away from its normal.
struct scene_shape {
    enum scene_shape_kind kind;
    struct timeline center; // m; any point of a plane
    struct timeline radius; // of a sphere, m
    struct timeline size;   // of a box: its sides along the world's axes, m
    struct timeline normal; // of a plane; any length but 0
};

enum scene_material_kind { SCENE_MATERIAL_DIFFUSE, SCENE_MATERIAL_MIRROR, SCENE_MATERIAL_DIELECTRIC };

// The share F of light that a smooth boundary reflects. In all cases F = 1 beyond the critical angle.
enum scene_fresnel {
    SCENE_FRESNEL_EXACT,   // for unpolarised light, by `ior`
    SCENE_FRESNEL_SCHLICK, // f0 + (f90 - f0) (1 - c)^5, with the cosine c on the side of the smaller ior
    SCENE_FRESNEL_NONE     // 0 for a dielectric; 1 for a diffuse material's specular share
};

struct scene_material {
    enum scene_material_kind kind;
    struct timeline albedo;       // diffuse: 1 or 3 components, [0, 1]; multiplied by the texture
    struct scene_texture texture; // diffuse
    struct timeline specular; // diffuse, [0, 1]: times F, the share reflected as by a mirror; the remainder is diffuse
    struct timeline reflectance; // mirror: 1 or 3 components, [0, 1]
    enum scene_fresnel fresnel;  // dielectric, and diffuse with a specular share
    struct timeline ior;         // the same, [0.1, 10]
    struct timeline f0, f90;     // Schlick, [0, 1]
    bool has_f0;                 // else f0 = ((ior - 1) / (ior + 1))^2, with the ior relative to the other side
    struct timeline roughness; // all that reflects or refracts, [0, 1]: normal + roughness * random unit-sphere vector
};

// A solid: the union of its shapes. Where objects overlap, only the later one exists.
struct scene_object {
    size_t first_shape, shape_count; // in scene.shapes
    bool is_union;                   // in the job
    struct scene_material material;
};

struct scene {
    struct scene_camera camera;
    struct scene_light lights[SCENE_LIGHT_LIMIT];
    size_t light_count;
    struct scene_medium media[SCENE_MEDIUM_LIMIT];
    size_t medium_count;
    bool has_vacuum; // the one medium is empty, and not of the job: scene_add_vacuum
    struct scene_shape shapes[SCENE_SHAPE_LIMIT];
    size_t shape_count;
    struct scene_object objects[SCENE_OBJECT_LIMIT];
    size_t object_count;
    struct timeline background; // radiance behind everything; it lights nothing
    bool has_background;
    // Lamps' and domes' light is scattered at most so often, by media and by diffuse surfaces, and emitted light once
    // less: [1, SCENE_ORDER_LIMIT], or SCENE_ORDERS_ALL.
    int orders;
};

void scene_finish(struct scene *scene);
// Adds an empty medium to a scene that has none: random paths between objects fly through media.
void scene_add_vacuum(struct scene *scene);
// Writes orders of scattering as a job states them: a number, or "all".
void scene_format_orders(int orders, char text[static SCENE_ORDERS_SIZE]);
// True when something lies behind everything, a background or a visible dome: then alpha is 1.
bool scene_has_behind(const struct scene *scene);
// True when all media have a density that scene_density_is_even knows, or there are none.
bool scene_media_are_even(const struct scene *scene);
// True when nothing in the scene changes with time.
bool scene_is_constant(const struct scene *scene);
// True when a density may differ between frames even if all its numbers are constant: a file for each frame, or code
// that gets the time.
bool scene_density_is_sequence(const struct scene_density *density);
// True when a density is constant inside its bounds at any one time: homogeneous without falloff.
bool scene_density_is_even(const struct scene_density *density);

// Writes the place of a medium in the job's document, "scene.media[0]" or "scene.objects[2].material.interior".
void scene_format_medium_place(const struct scene *scene, size_t medium, char *place, size_t size);

// The name of the first GLSL text of a density; NULL: there is none.
const char *scene_find_code(const struct scene *scene);

// Visits each number or vector that may move, always in the same order; `name` is short and not unique.
void scene_visit_timelines(struct scene *scene, timeline_visitor *visit, void *user);
