// Writes draws from phase functions for walks, and the media that these go through where the job asks for similar ones.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct scatter_grid;
struct scene_model;

// Writes WALK_SIMILAR_AFTER, the scatterings behind which media are similar (0: never), and for flights that
// shaders/scatter_grid/similar.glsl is to change:
//   Spectrum walk_extinction(MediaField field)
//   float walk_rate_share()        of media_rate, a majorant of that
//   Spectrum walk_transmittance(MediaColumn column)
// and, where media may be similar, for each that scatters:
//   float medium_I_similar()                                 what is left of its scattering
//   float medium_I_similar_phase(vec3 incoming, vec3 outgoing)    the phase function, times that
//   vec3 medium_I_similar_turned(vec3 direction, vec2 draw)       a draw from it
void scatter_similar_glue_write(FILE *out, const struct scene_model *model, const struct scatter_grid *grid);
// Writes vec3 medium_I_turned(vec3 direction, vec2 draw): a draw from the medium's phase function, a lobe by weight. In
// similar media, medium_I_similar_turned.
void scatter_similar_glue_write_turned(FILE *out, const struct scene_model *model, size_t medium, bool is_similar);
// A factor of medium I's scattering coefficient, or nothing.
void scatter_similar_glue_write_share(FILE *out, const struct scatter_grid *grid, size_t medium);
// A call that draws a direction from medium I's phase function, for `direction` and `draw`, expressions.
void scatter_similar_glue_write_turn(FILE *out, const struct scatter_grid *grid, size_t medium, const char *draw);
// A call of medium I's phase function for light.direction and direction, without the share.
void scatter_similar_glue_write_phase(FILE *out, const struct scatter_grid *grid, size_t medium);
