// A job's scene at one moment.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/camera_pinhole.h"
#include "reference/density_bounded.h"
#include "reference/density_fold_fractal.h"
#include "reference/density_function.h"
#include "reference/density_grid.h"
#include "reference/density_homogeneous.h"
#include "reference/density_noise.h"
#include "reference/dome.h"
#include "reference/glow_blackbody.h"
#include "reference/light.h"
#include "reference/medium.h"
#include "reference/objects.h"
#include "reference/sphere_light.h"

#include <stdbool.h>
#include <stddef.h>

struct job;

// A grid as read from its file; values NULL: none.
struct still_grid {
    const float *values; // borrowed; outlives the still; i fastest
    int size[3];
    double index_to_world[12];
    bool is_padded; // the outermost voxels are the background: the box ends at their centres, else half a voxel beyond
};

struct still_function {
    density_function_at *at; // NULL: none
    const void *context;     // borrowed; outlives the still
};

// An image as read from its file; rgb NULL: none.
struct still_texture {
    const float *rgb; // borrowed; outlives the still; linear, 3 a texel, rows from the top
    int width, height;
};

// The inputs of a still beside the job, by index of the medium or the object.
struct still_inputs {
    struct still_grid grids[SCENE_MEDIUM_LIMIT];
    struct still_grid temperatures[SCENE_MEDIUM_LIMIT];  // of media that glow as black bodies
    struct still_function functions[SCENE_MEDIUM_LIMIT]; // twins of densities in GLSL
    struct still_texture textures[SCENE_OBJECT_LIMIT];
    struct still_texture dome; // of a dome in a file
};

// The field of a medium, by its density's kind.
union still_field {
    struct density_fold_fractal fold_fractal;
    struct density_homogeneous homogeneous;
    struct density_noise noise;
    struct density_grid grid;
    struct density_function function;
};

// The media point into their still: a copy must not outlive it. Tests may fill it by hand.
struct still {
    struct camera_pinhole camera;
    struct light lights[SCENE_LIGHT_LIMIT]; // without size
    size_t light_count;
    struct sphere_light spheres[SCENE_LIGHT_LIMIT];
    size_t sphere_count;
    struct dome dome; // has_dome
    bool has_dome;
    struct medium media[SCENE_MEDIUM_LIMIT]; // media of one region are adjacent
    size_t medium_count;
    struct objects objects;
    int max_depth;         // reflections and refractions of a ray
    double min_throughput; // rays of smaller throughput are cut
    union still_field fields[SCENE_MEDIUM_LIMIT];
    struct density_bounded bounded[SCENE_MEDIUM_LIMIT]; // of the media that have bounds
    struct glow_blackbody glows[SCENE_MEDIUM_LIMIT];    // of media that glow as black bodies
    double background[3];                               // radiance
    bool has_background;
    // False when a density has neither twin nor input and counts as 0, a texture has no input and counts as white,
    // or a dome's file has none and is black.
    bool is_complete;
};

struct still_media {
    const struct medium *list; // borrowed; outlives us
    size_t count;
};

void still_init(struct still *still, const struct job *job, double time); // time in seconds
// The job must outlive the still where it has transfer functions.
void still_init_with_inputs(struct still *still, const struct job *job, double time, const struct still_inputs *inputs);
// The media that fill a region.
struct still_media still_media(const struct still *still, size_t region);
// The medium's field; borrowed by the density it makes.
struct density still_fractal_density(const struct density_fold_fractal *fractal);
