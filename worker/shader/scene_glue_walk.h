// Writes the part of a scene's shader that random paths ask: coefficients, lights and directions at a vertex.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// What shaders/scatter/walk.glsl calls, after media, majorants and lights; all coefficients are per metre:
//   walk_extinction(field), walk_scattering(field), walk_emission(field, point)
//   walk_least(length)   samples per metre that a flight needs at least, where some medium is
//   walk_light(point, incoming, field, weight, light)  samples the lights: what of the path's `weight` one of them
//   adds, and where it is; is the transmittance of the media known, that is in it, and the light is at no distance
//   walk_near_find()     finds how far around each lamp vertices of their own are drawn (scatter/near.glsl)
//   walk_near(point, incoming, field, weight, near), walk_near_start(ray, near)  draw one; return the weight of the
//   flight there, 0 where there is none
//   walk_lamp(lamp, point, incoming, field, weight, light)  as walk_light, for the vertex near a lamp
//   walk_passed(spans, distance)  the media's transmittance, where WALK_TRACKS is false
//   walk_scatter(field, incoming, weight, outgoing)  draws a direction; returns the weight behind
// and how many flights a turn of its loop takes at most, how many cells of the majorant a flight goes through, and how
// many turns there are before it is to be continued, so that software GL cuts no loop:
//   WALK_FLIGHTS, WALK_CELLS, WALK_TURNS
// and whether only scattered light counts (core/job/job_layers.h):
//   WALK_IS_LAYER
void scene_glue_write_walk(FILE *out, const struct scene_model *model);
// Writes `walk_start(path)` for camera rays, and the variables that it reads.
void scene_glue_write_walk_start(FILE *out);
