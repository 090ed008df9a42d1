// Writes what walks against the light ask of a scene: what media emit and scatter, and where light goes on from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct scatter_grid;
struct scene_model;

// What the text is written of. Where lamp_count is not 0, scatter_grid/aim.glsl is there: walks look for the lamps.
struct scatter_walk_text {
    FILE *out;
    const struct scene_model *model;
    const struct scatter_grid *grid;
    int lamp_count;
};

// True where a medium has a lobe of Henyey and Greenstein.
bool scatter_walk_glue_is_forward(const struct scene_model *model, const struct scatter_grid *grid);
// True where such a lobe is so sharp that walks should look for lamps.
bool scatter_walk_glue_is_sharp(const struct scene_model *model, const struct scatter_grid *grid);
// Writes what aim.glsl asks: WALK_LAMPS, whose number it returns, and
//   vec3 walk_lamp(int lamp, vec3 point)    the direction to a lamp
int scatter_walk_glue_write_lamps(FILE *out, const struct scene_model *model);
// Writes, for media whose functions and phases are there:
//   void walk_scatter(MediaField field, vec3 point, vec3 direction, inout Spectrum weight, out vec3 turned)
//                     multiplies the weight by the scattering coefficient and draws where light comes from, or goes on
//   vec3 medium_I_turned(vec3 direction, vec2 draw)    draws from a medium's phase function
//   Spectrum walk_kept(vec3 rgb)
void scatter_walk_glue_write_scatter(const struct scatter_walk_text *text);
// Writes that, and:
//   Spectrum walk_emission(MediaField field, vec3 point)              what media emit, per metre
//   Spectrum walk_lit(MediaField field, vec3 point, vec3 direction)   lights' light that media scatter against
//                                                                     `direction`, per metre
//   Spectrum walk_sky(vec3 toward)                                    domes' light, where a walk leaves the media;
//                                                                     WALK_HAS_SKY: there is some
//   float walk_first(int set, vec3 node, vec3 away, vec2 share, out vec3 toward)
//                                                                     a walk's first direction, by the phase function
//                                                                     of a set of values, and its weight
//   WALK_SAMPLES, the least mean number of samples along a flight
void scatter_walk_glue_write(const struct scatter_walk_text *text);
