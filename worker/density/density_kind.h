// How one kind of density enters a scene's shader: what the files density_KIND.c each fill in.
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

// Where a density stands: names it makes start with "medium_<medium>_".
struct density_site {
    const struct job *job;
    size_t medium;
    const struct scene_medium *source; // job->scene.media[medium]
    const struct scene_inputs *inputs; // the frame's open files; NULL when the job has none
    bool fills_grid; // for the program that fills the medium's grid (density_bake.h), not for one that looks into it
};

// Code of the job's own: a module between generated lines.
struct density_text {
    const char *name;     // for messages; borrowed from the job
    const char *text;     // borrowed from the job
    char *before, *after; // owned
};

// A new kind is one file with one of these, called density_kind_KIND, and a line in density_kind.c's table.
struct density_kind {
    const char *name;         // as in the job
    const char *field_type;   // GLSL type of the field, made from one float by TYPE(0.0): "float", "vec2", ...
    bool is_even;             // rho is the same wherever it is not 0: columns in closed form, no steps
    bool has_support;         // `write` emits medium_I_support
    bool is_zero_outside;     // the field itself makes density 0 outside the support
    bool takes_time;          // `write` uses time_s, the frame's time
    bool takes_anchor;        // and, where scene_anchor_is_used, scene_anchor: what to add to a place for the world's
    bool takes_direction;     // medium_I_field has a second parameter, the unit direction of the ray it is asked along
    bool has_stated_majorant; // the job states its majorant, which may be too low; `write` checks it
    // True when there is none at any time: the medium then costs nothing.
    bool (*is_zero)(const struct scene_density *density);
    // A transfer function: its density is the extinction coefficient itself, and `write` emits medium_I_color. NULL: never.
    bool (*has_color)(const struct scene_density *density);
    // A transfer function of values that are linear between voxels: with JOB_METHOD_PREINTEGRATED `write` emits what is said
    // of tables. NULL: never.
    bool (*has_table)(const struct scene_density *density);
    // Frame values that `write` uses. Those of the bounds, medium_I_bounds_center among them, are there without it.
    void (*add_values)(struct frame_uniforms *uniforms, const struct density_site *site);
    // Shader modules it uses, in order, ends in NULL; static strings.
    const char *const *(*modules)(const struct density_site *site);
    // The job's own code, which comes before what `write` emits; its mistakes that can be seen without a compiler. NULL: none.
    bool (*load_text)(const struct density_site *site, struct density_text *text, struct error *error);
    // Emits, FIELD being the field's type:
    // - vec2 medium_I_support(vec3 origin, vec3 direction): distances along the ray outside of which there is no density,
    //   entry >= exit for none (has_support). What lies outside is never asked for, unless is_zero_outside.
    // - FIELD medium_I_field(vec3 p [, vec3 direction]): the costly part, taken once a place.
    // - float medium_I_density(FIELD field): rho >= 0; finite for FIELD(0.0) too.
    // - float medium_I_distance(FIELD field): negative where there may be density; else there is none before that distance
    //   along the ray, on which nothing but this is asked: 0 when nothing is known.
    // - vec3 medium_I_color(FIELD field) (has_color): source per density.
    // - TransferEnd medium_I_end(vec3 p), also outside of the support, TransferEnd medium_I_end_at(float place), and
    //   float medium_I_clear(vec3 p, vec3 direction): how far along the ray there is none, 0 when nothing is known; and
    //   medium_I_density and medium_I_color of a vec4, which is what transfer_mean gives (has_table).
    // - vec3 medium_I_glow(vec3 p) (the medium has a blackbody): source per density.
    // Opaque types (textures) it declares itself, at the medium's units (texture_units.h).
    void (*write)(FILE *out, const struct density_site *site);
    // What follows is for tracking among majorants (scene_features.has_majorants).
    // Adds medium_I_majorant, which the density before what the bounds' falloff leaves of it is nowhere above; NULL: there is
    // write_most.
    void (*add_majorant)(struct frame_uniforms *uniforms, const struct density_site *site);
    // Emits float medium_I_most(vec3 p, vec3 direction, inout float reach): such a number that holds for `reach` metres from p
    // on, which it may shorten. NULL: medium_I_majorant holds everywhere.
    void (*write_most)(FILE *out, const struct density_site *site);
    const char *majorant_module; // that these and `write` need then; NULL: none
    // What follows is of kinds that may be baked (density_bake.h); else find_box is NULL.
    // Half the sides of a box around the bounds' centre that holds the medium throughout the job, in axes that stand still
    // for the field: the grid's. False where there is none.
    bool (*find_box)(const struct density_site *site, double half_size[static 3]);
    // False when a look into such a grid is no cheaper than the field. NULL: it always is.
    bool (*pays_baked)(const struct density_site *site, const struct density_bake *bake);
    // Where the site fills a grid: the frame values that write_baked uses. The medium is baked, so that `add_values` and
    // `write` are for programs that have density_bake_write_lookup.
    void (*add_baked_values)(struct frame_uniforms *uniforms, const struct density_site *site);
    // Emits float medium_I_baked(vec3 p): what is put into the grid; p is in metres from the bounds' centre along its axes.
    void (*write_baked)(FILE *out, const struct density_site *site);
};

extern const struct density_kind density_kind_fold_fractal, density_kind_homogeneous, density_kind_noise,
    density_kind_grid, density_kind_bricks, density_kind_glsl;

// NULL for a kind that cannot be rendered yet.
const struct density_kind *density_kind_of(const struct scene_density *density);
