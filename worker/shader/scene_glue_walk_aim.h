// Writes how random paths go on from a vertex.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct scene_model;

// Whether some directions are drawn about a lamp, which needs shaders/scatter/aim.glsl: above order 1, where media
// scatter in narrow lobes and are thin, or have the grids of lights.
bool scene_glue_walk_has_aims(const struct scene_model *model);
// After walk_scatter and walk_scattered, and where some are, scene_glue_write_walk_lamps:
//   walk_turn(point, incoming, vertex, weight, order, outgoing)  draws the direction in which a path goes on behind its
//   vertex of that order, and returns its weight there.
void scene_glue_write_walk_aim(FILE *out, const struct scene_model *model);
