// Writes how vertices send second paths towards lamps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct scene_model;

// Whether there are lamps whose light that reaches a vertex is known there, above order 1.
bool scene_glue_walk_knows_lamps(const struct scene_model *model);
// The largest g, times `sign`, of the lobes of all media at all times; 0: none is larger.
double scene_glue_walk_find_lobe(const struct scene_model *model, double sign);

// Whether vertices may send second paths, which needs shaders/scatter/aside.glsl: where such lamps are, lobes are very
// narrow, and no surface is.
bool scene_glue_walk_sends(const struct scene_model *model);
// After walk_scatter and walk_scattered, before what scene_glue_walk_aim writes:
//   WALK_SENDS            whether they may
//   walk_sends()          whether they do: no lamp lies within a medium
//   walk_aside_goes_on()  the chance that a second path goes on behind a vertex
//   walk_aside_density(point, incoming, vertex, weight, outgoing)  of second paths in that direction, their chance
//                         included, relative to that of the path itself
//   walk_aside(point, incoming, vertex, weight, outgoing)  draws whether one is sent and its direction, and returns its
//                         weight there, or 0
void scene_glue_write_walk_aside(FILE *out, const struct scene_model *model);
