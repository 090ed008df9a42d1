// Writes what particles that fly out from the lights ask of a scene: where they begin, and with what.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scatter_grid;
struct scene_model;

// Writes, for lights whose functions are there:
//   float walk_powers_find()    the power of all that particles bring, and of each light walk_powers[WALK_LIGHTS]
//   bool walk_begin(int light, vec2 share, out ScatterSource source, out Spectrum power)    draws a particle; true:
//                                                                                    it comes from afar
//   float walk_fall(int light, vec3 point)    what the light's particles count at their first scattering
//   bool walk_is_first(int light)             light that no medium has scattered counts, too
//   float walk_phase(int set, vec3 incoming, vec3 outgoing)    the phase function of a set of the grid's values
//   SCATTER_GRID_SETS
void scatter_send_glue_write(FILE *out, const struct scene_model *model, const struct scatter_grid *grid);
