// What is in front of the camera and how light passes through it. Metres, seconds, radians; coefficients per metre.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/timeline.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SCENE_LIGHT_LIMIT = 16,
    SCENE_MEDIUM_LIMIT = 8, // interiors among them
    SCENE_LOBE_LIMIT = 8,
    SCENE_OBJECT_LIMIT = 16,
    SCENE_SHAPE_LIMIT = 32,     // of all objects
    SCENE_ITERATION_LIMIT = 32, // of a fold fractal
    SCENE_OCTAVE_LIMIT = 16,    // of a noise
    SCENE_TRANSFER_LIMIT = 64,  // points of a transfer function
    SCENE_GRID_SIDE_LIMIT = 65536,
    SCENE_GLSL_SIZE_LIMIT = 64 * 1024, // bytes of a user's density
    SCENE_GLSL_LINE_LIMIT = 5000       // of it: fewer than the numbers between two modules' first lines
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

enum scene_density_kind {
    SCENE_DENSITY_FOLD_FRACTAL,
    SCENE_DENSITY_HOMOGENEOUS,
    SCENE_DENSITY_NOISE,
    SCENE_DENSITY_GRID,
    SCENE_DENSITY_GLSL
};

// rho(p) = scale max(radius - |fold^iterations(p)|, 0)^exponent; see docs/job_format.md. 1-Lipschitz distance; zero outside
// |p| = radius + iterations sqrt(3) offset.
struct scene_fold_fractal {
    int iterations;                             // [1, SCENE_ITERATION_LIMIT]
    struct timeline offset, radius;             // m
    struct timeline rotate_x_rad, rotate_y_rad; // angle per iteration
    struct timeline exponent;                   // > 0
    struct timeline scale;                      // >= 0
};

// rho(p) = scale.
struct scene_homogeneous {
    struct timeline scale; // >= 0
};

enum scene_noise_mode {
    SCENE_NOISE_REMAP,   // max((1 + sum) / 2, 0)
    SCENE_NOISE_CLIP,    // max(sum, 0)
    SCENE_NOISE_ABSOLUTE // the sum of the octaves' absolute values: turbulence
};

// rho(p) = scale mode(sum over octaves k of lacunarity^(-hurst k) noise(lacunarity^k q))^((1 - bias) / (1 + bias)) with
// q = frequency R (p - the bounds' centre) + offset, R turning by `angle` about `axis`. Noise: Perlin, SIGGRAPH 2002.
struct scene_noise {
    int octaves; // [1, SCENE_OCTAVE_LIMIT]
    enum scene_noise_mode mode;
    struct timeline frequency;  // lattice cells per metre, > 0
    struct timeline lacunarity; // [1, 100]
    struct timeline hurst;      // "H": [0, 10]
    struct timeline bias;       // [-0.999, 0.999]; 0 changes nothing
    struct timeline offset;     // lattice cells
    struct timeline axis;       // of any length but 0
    struct timeline angle;      // degrees
    struct timeline scale;      // >= 0
};

enum scene_voxel { SCENE_VOXEL_UINT8, SCENE_VOXEL_UINT16, SCENE_VOXEL_INT16, SCENE_VOXEL_FLOAT32 };

// How a raw file is read. What is not given is taken from a name like "head_256x256x109xuint8.raw".
struct scene_raw {
    int size[3]; // voxels along x, y, z, x fastest, each up to SCENE_GRID_SIDE_LIMIT; 0: by the name
    enum scene_voxel type;
    bool has_type;
    bool is_big_endian;
    int64_t skip_bytes; // before the first voxel
};

// Straight linear Rec. 709 colour and opacity at a value; between points all four are linear, outside they hold.
struct scene_transfer_point {
    double value;
    double rgba[4]; // rgb >= 0, a in [0, 1 - 1e-6]
};

// rho(p) = scale max(value, 0); or by a transfer function: sigma_t = -ln(1 - a) / unit_distance, source = rgb sigma_t.
struct scene_grid {
    char *file;      // owned; see core/scene/input_path.h
    char *grid_name; // owned; of a NanoVDB file, which may hold several; NULL: its first
    struct scene_raw raw;
    double spacing[3]; // m; 0: as the file says
    bool is_nearest;   // else trilinear
    bool has_center;
    struct timeline center; // m: moves the grid's middle there, of a NanoVDB file its origin; without: as the file says
    struct timeline scale;  // >= 0, density per value
    struct scene_transfer_point *points; // owned; ascending values; none: no transfer function
    size_t point_count;                  // [2, SCENE_TRANSFER_LIMIT] or 0
    struct timeline unit_distance;       // m, > 0
};

// rho(p) = scale max(density(p, t), 0), the function being the user's.
struct scene_glsl {
    char *file;       // owned; for messages; NULL: the text is from the job itself
    char *source;     // owned; `float density(vec3 p, float t)` and what it calls; NULL: still to be read from `file`
    double lipschitz; // > 0: |density(p) - density(q)| <= lipschitz |p - q|, negative outside; 0: nothing is known
    double majorant;  // > 0: density() is nowhere above; 0: nothing is known
    struct timeline scale; // >= 0
};

enum scene_bounds_kind { SCENE_BOUNDS_NONE, SCENE_BOUNDS_SPHERE, SCENE_BOUNDS_BOX, SCENE_BOUNDS_SLAB };

// Outside it a density is zero; inside it is multiplied with smoothstep(0, falloff, distance to the nearest face).
struct scene_bounds {
    enum scene_bounds_kind kind;
    struct timeline center;    // m
    struct timeline radius;    // of a sphere, m
    struct timeline size;      // of a box: its sides along the world's axes, m
    struct timeline normal;    // of a slab, of any length but 0
    struct timeline thickness; // of a slab, m
    struct timeline falloff;   // m; 0: none
};

struct scene_density {
    enum scene_density_kind kind;
    struct scene_bounds bounds;
    union { // by kind
        struct scene_fold_fractal fold_fractal;
        struct scene_homogeneous homogeneous;
        struct scene_noise noise;
        struct scene_grid grid;
        struct scene_glsl glsl;
    };
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
// True when its file is one of named, sparse grids.
bool scene_grid_is_vdb(const struct scene_grid *grid);
// True when it is the same everywhere inside its bounds at any one time: homogeneous without falloff.
bool scene_density_is_even(const struct scene_density *density);

// What messages call the user's text: its file's name, without folders.
const char *scene_glsl_name(const struct scene_glsl *glsl);
// The place of a medium in the job's document, "scene.media[0]" or "scene.objects[2].material.interior"; of `size` bytes.
void scene_format_medium_place(const struct scene *scene, size_t medium, char *place, size_t size);

// The name of the first text by the user that a density follows; NULL: there is none.
const char *scene_find_code(const struct scene *scene);

// Called for each number or vector that may move, always in the same order; `name` is short and not unique.
typedef void scene_visitor(const char *name, struct timeline *timeline, void *user);
void scene_visit_timelines(struct scene *scene, scene_visitor *visit, void *user);
