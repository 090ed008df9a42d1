// Writes what walks against the light ask of a scene: what media emit and scatter, and where light goes on from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scatter_grid;
struct scene_model;

// Writes, for media whose functions and phases are there:
//   void walk_scatter(MediaField field, vec3 direction, inout Spectrum weight, out vec3 turned)
//                     multiplies the weight by the scattering coefficient and draws where light comes from, or goes on
//   vec3 medium_I_turned(vec3 direction, vec2 draw)    draws from a medium's phase function
//   Spectrum walk_kept(vec3 rgb)
void scatter_walk_glue_write_scatter(FILE *out, const struct scene_model *model, const struct scatter_grid *grid);
// Writes that, and:
//   Spectrum walk_emission(MediaField field, vec3 point)              what media emit, per metre
//   Spectrum walk_lit(MediaField field, vec3 point, vec3 direction)   lights' light that media scatter against
//                                                                     `direction`, per metre
//   Spectrum walk_sky(vec3 toward)                                    domes' light, where a walk leaves the media;
//                                                                     WALK_HAS_SKY: there is some
//   vec3 walk_first(int set, vec3 direction, vec2 draw)    draws from the phase function of a set of the grid's values
//   WALK_SAMPLES, the least mean number of samples along a flight
void scatter_walk_glue_write(FILE *out, const struct scene_model *model, const struct scatter_grid *grid);
