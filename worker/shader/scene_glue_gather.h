// Writes the part of a scene's shader that adds a segment of a ray to its pixel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct job;
struct scene_model;

// Writes `Gathered` and `gather`, which the integrator calls for each point that has density.
void scene_glue_write_gather(FILE *out, const struct scene_model *model);
// Writes `PLACED_COUNT`, `placed_share(i)` and `placed_weight(i)`: the points of a stretch, for jobs that place them.
void scene_glue_write_placed(FILE *out, const struct job *job);
// Writes the expression of the transmittance of the media in `spans` between `point` and `distance` metres towards
// `light`.
void scene_glue_write_transmittance(FILE *out, const struct scene_model *model, const char *spans,
                                    const char *distance);
// Writes the integrator's call for `spans`. `stretch`: "origin, direction, interval", of Riemann sums without the
// interval.
void scene_glue_write_integrator(FILE *out, const struct scene_model *model, const char *stretch);
