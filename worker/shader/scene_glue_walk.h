// Writes the part of a scene's shader that random paths ask: coefficients, lights and directions at a vertex.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// What shaders/scatter/walk.glsl calls beside lights, after media and majorants; all coefficients are per metre:
//   walk_extinction(field), walk_scattering(field), walk_emission(field, point)
//   walk_least(length)   samples per metre that a flight needs at least, where some medium is
//   walk_scattered(vertex, incoming, outgoing)  what is scattered from one direction to another
//   walk_scatter(field, incoming, weight, outgoing)  draws a direction; returns the weight behind
// and how many flights a turn of its loop takes at most, how many cells of the majorant a flight goes through, and how
// many turns there are before it is to be continued, so that software GL cuts no loop:
//   WALK_FLIGHTS, WALK_CELLS, WALK_TURNS
// and whether only scattered light counts (core/job/job_layers.h):
//   WALK_IS_LAYER
void scene_glue_write_walk(FILE *out, const struct scene_model *model);
// Writes `walk_start(path)` for camera rays, and the variables that it reads.
void scene_glue_write_walk_start(FILE *out);
