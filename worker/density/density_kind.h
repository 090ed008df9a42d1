// Kinds of densities, as they enter a scene's shader: each file density_KIND.c fills in one struct.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct density_bake;
struct error;
struct frame_uniforms;
struct job;
struct scene_inputs;

// A density of a job. The names that its kind makes start with "medium_<medium>_".
struct density_site {
    const struct job *job;
    size_t medium;
    const struct scene_medium *source; // job->scene.media[medium]
    const struct scene_inputs *inputs; // the frame's open files; NULL when the job has none
    bool fills_grid; // for the program that fills the medium's grid (density_bake.h), not for those that read it
};

// The job's own code: a module between generated lines.
struct density_text {
    const char *name;     // for messages; borrowed from the job
    const char *text;     // borrowed from the job
    char *before, *after; // owned
};

// A new kind is one file with one of these, called density_kind_KIND, and a row in density_kind.c's table.
struct density_kind {
    const char *name;       // as in the job
    const char *field_type; // GLSL type of the field, made from one float by TYPE(0.0): "float", "vec2", ...
    bool is_even;           // homogeneous: rho is the same wherever it is not 0, columns have a closed form
    bool has_support;       // `write` emits medium_I_support
    bool is_zero_outside;   // the field itself makes density 0 outside the support
    bool takes_time;        // `write` uses time_s, the frame's time
    bool takes_anchor; // and, where scene_anchor_is_used, scene_anchor: the world's coordinates of the shader's origin
    bool takes_direction;     // medium_I_field has a second parameter, the unit direction of the ray
    bool has_stated_majorant; // the job states its majorant, which may be too low; `write` checks it
    // Returns true when the density is 0 at all times: the medium then costs nothing.
    bool (*is_zero)(const struct scene_density *density);
    // Returns true for a transfer function: its density is the extinction coefficient itself, and `write` emits
    // medium_I_color. NULL: never.
    bool (*has_color)(const struct scene_density *density);
    // Returns true for a transfer function of values that are linear between voxels: with JOB_METHOD_PREINTEGRATED
    // `write` emits the functions marked has_table below. NULL: never.
    bool (*has_table)(const struct scene_density *density);
    // Adds the frame values that `write` uses. Those of the bounds, medium_I_bounds_center among them, are added
    // anyway.
    void (*add_values)(struct frame_uniforms *uniforms, const struct density_site *site);
    // Returns the shader modules that it uses, in order, ending in NULL; static strings.
    const char *const *(*modules)(const struct density_site *site);
    // Loads the job's own code, which comes before what `write` emits, and refuses mistakes that need no compiler.
    // NULL: none.
    bool (*load_text)(const struct density_site *site, struct density_text *text, struct error *error);
    // Emits, FIELD being the field's type:
    // - vec2 medium_I_support(vec3 origin, vec3 direction): distances along the ray outside of which the density is 0,
    //   entry >= exit for none (has_support). Points outside are never asked for, unless is_zero_outside.
    // - FIELD medium_I_field(vec3 p [, vec3 direction]): the costly part, evaluated once a point.
    // - float medium_I_density(FIELD field): rho >= 0; finite for FIELD(0.0) too.
    // - float medium_I_distance(FIELD field): negative where there may be density; else the density is 0 for that
    //   distance along the ray, 0 when nothing is known. Nothing else is asked of such a field.
    // - vec3 medium_I_color(FIELD field) (has_color): source per density.
    // - TransferEnd medium_I_end(vec3 p), also outside of the support, TransferEnd medium_I_end_at(float position), and
    //   float medium_I_clear(vec3 p, vec3 direction): how far along the ray the density is 0, 0 when nothing is known;
    //   and medium_I_density and medium_I_color of a vec4, the value of transfer_mean (has_table).
    // - vec3 medium_I_glow(vec3 p) (the medium has a blackbody): source per density.
    // It declares textures itself, at the medium's units (texture_units.h).
    void (*write)(FILE *out, const struct density_site *site);
    // The next four are for tracking among majorants (scene_features.has_majorants).
    // Adds medium_I_majorant, an upper bound on the density before the bounds' falloff. NULL: there is write_most.
    void (*add_majorant)(struct frame_uniforms *uniforms, const struct density_site *site);
    // Emits float medium_I_most(MediaRay ray, float at, inout float extent): an upper bound that holds for `extent`
    // metres along the ray from `at` on, which it may shorten. NULL: medium_I_majorant holds everywhere. Emits before
    // TYPE medium_I_ray(vec3 origin, vec3 direction), which makes ray.medium_I.
    void (*write_most)(FILE *out, const struct density_site *site);
    const char *ray_type;        // TYPE: what does not change along a ray; NULL: nothing is made
    const char *majorant_module; // that these and `write` need then; NULL: none
    // The rest is for kinds that may be baked (density_bake.h); else find_box is NULL.
    // Finds half the sides of a box around the bounds' centre that holds the medium throughout the job, along axes in
    // which the field stands still: the grid's axes. Returns false where there is none.
    bool (*find_box)(const struct density_site *site, double half_size[static 3]);
    // Returns false when reading such a grid is no cheaper than the field. NULL: it always is cheaper.
    bool (*pays_baked)(const struct density_site *site, const struct density_bake *bake);
    // Adds the frame values that write_baked uses, where the site fills a grid. `add_values` and `write` are for
    // programs that read the grid by density_bake_write_lookup.
    void (*add_baked_values)(struct frame_uniforms *uniforms, const struct density_site *site);
    // Emits float medium_I_baked(vec3 p): the value for the grid; p is in metres from the bounds' centre along the
    // grid's axes.
    void (*write_baked)(FILE *out, const struct density_site *site);
};

extern const struct density_kind density_kind_fold_fractal, density_kind_homogeneous, density_kind_noise,
    density_kind_grid, density_kind_bricks, density_kind_glsl;

const struct density_kind *density_kind_of(const struct scene_density *density);
