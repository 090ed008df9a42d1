// The density of a medium: the values of every kind of it, and its bounds. Metres, seconds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/timeline.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SCENE_ITERATION_LIMIT = 32, // of a fold fractal
    SCENE_OCTAVE_LIMIT = 16,    // of a noise
    SCENE_TRANSFER_LIMIT = 64,  // points of a transfer function
    SCENE_GRID_SIDE_LIMIT = 65536,
    SCENE_GLSL_SIZE_LIMIT = 64 * 1024, // bytes of a user's GLSL
    SCENE_GLSL_LINE_LIMIT = 5000       // less than the line numbers between two shader modules
};

enum scene_density_kind {
    SCENE_DENSITY_FOLD_FRACTAL,
    SCENE_DENSITY_HOMOGENEOUS,
    SCENE_DENSITY_NOISE,
    SCENE_DENSITY_GRID,
    SCENE_DENSITY_GLSL
};

// rho(p) = scale max(radius - |fold^iterations(p)|, 0)^exponent; see docs/job_format.md. 1-Lipschitz distance; zero
// outside |p| = radius + iterations sqrt(3) offset.
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
// q = frequency R (p - the bounds' centre) + offset; R rotates by `angle` about `axis`. Noise: Perlin, SIGGRAPH 2002.
struct scene_noise {
    int octaves; // [1, SCENE_OCTAVE_LIMIT]
    enum scene_noise_mode mode;
    struct timeline frequency;  // lattice cells per metre, > 0
    struct timeline lacunarity; // [1, 100]
    struct timeline hurst;      // "H": [0, 10]
    struct timeline bias;       // [-0.999, 0.999]; 0 changes nothing
    struct timeline offset;     // lattice cells
    struct timeline axis;       // any length but 0
    struct timeline angle;      // degrees
    struct timeline scale;      // >= 0
};

enum scene_voxel { SCENE_VOXEL_UINT8, SCENE_VOXEL_UINT16, SCENE_VOXEL_INT16, SCENE_VOXEL_FLOAT32 };

// The layout of a raw file. Values that are not given come from a name like "head_256x256x109xuint8.raw".
struct scene_raw {
    int size[3]; // voxels along x, y, z, x fastest, each up to SCENE_GRID_SIDE_LIMIT; 0: see the name
    enum scene_voxel type;
    bool has_type;
    bool is_big_endian;
    int64_t skip_bytes; // before the first voxel
};

// Colour (linear Rec. 709, not premultiplied) and opacity at a value. All four are interpolated linearly between points
// and constant outside them.
struct scene_transfer_point {
    double value;
    double rgba[4]; // rgb >= 0, a in [0, 1 - 1e-6]
};

// rho(p) = scale max(value, 0); or by a transfer function: sigma_t = -ln(1 - a) / unit_distance, source = rgb sigma_t.
struct scene_grid {
    char *file;      // owned; see core/scene/input_path.h
    char *grid_name; // owned; a grid of a NanoVDB file; NULL: its first
    struct scene_raw raw;
    double spacing[3]; // m; 0: see the file
    bool is_nearest;   // else trilinear
    bool has_center;
    struct timeline center; // m: moves the grid's middle there, a NanoVDB file's origin; absent: see the file
    struct timeline scale;  // >= 0, density per value
    struct scene_transfer_point *points; // owned; ascending values; none: no transfer function
    size_t point_count;                  // [2, SCENE_TRANSFER_LIMIT] or 0
    struct timeline unit_distance;       // m, > 0
};

// rho(p) = scale max(density(p, t), 0), with a function of the user's.
struct scene_glsl {
    char *file;            // owned; for messages; NULL: the job itself has the text
    char *source;          // owned; `float density(vec3 p, float t)` and what it calls; NULL: to be read from `file`
    double lipschitz;      // > 0: |density(p) - density(q)| <= lipschitz |p - q|, negative outside; 0: unknown
    double majorant;       // > 0: an upper bound of density(); 0: unknown
    struct timeline scale; // >= 0
};

enum scene_bounds_kind { SCENE_BOUNDS_NONE, SCENE_BOUNDS_SPHERE, SCENE_BOUNDS_BOX, SCENE_BOUNDS_SLAB };

// Outside the bounds a density is zero; inside it is multiplied by smoothstep(0, falloff, distance to the nearest
// face).
struct scene_bounds {
    enum scene_bounds_kind kind;
    struct timeline center;    // m
    struct timeline radius;    // of a sphere, m
    struct timeline size;      // of a box: its sides along the world's axes, m
    struct timeline normal;    // of a slab; any length but 0
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

// True when its file has named, sparse grids.
bool scene_grid_is_sparse(const struct scene_grid *grid);
// The name of the user's text in messages: its file's, without folders.
const char *scene_glsl_name(const struct scene_glsl *glsl);
