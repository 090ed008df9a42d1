// Writes how vertices send second paths towards lamps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct scene_model;

// The largest g, times `sign`, of the lobes of all media at all times; 0: none is larger.
double scene_glue_walk_find_lobe(const struct scene_model *model, double sign);

// Whether vertices may send second paths, by shaders/scatter/aside.glsl instead of no_aside.glsl: where there are lamps
// as scene_glue_walk_knows_lamps says, lobes are very narrow, and no surface is.
bool scene_glue_walk_sends(const struct scene_model *model);
// What that module calls:
//   walk_sends()          whether they do: no lamp lies within a medium
//   walk_aside_goes_on()  the chance that a second path goes on behind a vertex
//   WALK_ASIDE_SIDE       1 where lobes send light on, -1 where back
void scene_glue_write_walk_aside(FILE *out, const struct scene_model *model);
