// Writes how lights shine on the vertices of random paths.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct scene_model;

// Whether vertices are drawn near this lamp where it lies in a medium: walk_reach_I says how far around, or 0.
bool scene_glue_walk_has_near(const struct scene_model *model, size_t i);

// What shaders/scatter/walk.glsl calls, after the media's coefficients, walk_scatter, and walk_wall. What reaches a
// vertex is known at once where all media that count have columns in closed form or in a light's grid; it is added to
// `sum`. Elsewhere a flight leads to the light: WALK_FLIES says whether there are any.
//   walk_known(point, incoming, vertex, weight, sum)  what is scattered of such light; in media that have lights' grids
//   at each point that a flight looks at (WALK_GATHERS), else where a path is scattered
//   walk_light(point, incoming, vertex, weight, light)  samples the others: the weight of a flight to one of them, and
//   where it is
//   walk_near_find()     finds how far around each lamp vertices of their own are drawn (scatter/near.glsl)
//   walk_near(point, incoming, vertex, weight, near, sum), walk_near_start(ray, near, sum)  draw one; return the weight
//   of the flight there, 0 where there is none
//   walk_lamp(lamp, point, incoming, vertex, weight, light, sum)  as walk_light, for the vertex near a lamp
void scene_glue_write_walk_lights(FILE *out, const struct scene_model *model);
