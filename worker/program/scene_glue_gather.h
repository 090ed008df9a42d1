// Writes the part of a scene's shader that adds a segment of a ray to its pixel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct job;
struct scene_model;

// `Gathered` and `gather`, called by the integrator for each place that has density.
void scene_glue_write_gather(FILE *out, const struct scene_model *model);
// `PLACED_COUNT`, `placed_share(i)` and `placed_weight(i)`: the points of a stretch, for jobs that place them.
void scene_glue_write_placed(FILE *out, const struct job *job);
// The expression of what the media in `spans` leave of light between `point` and `distance` metres towards `light`.
void scene_glue_write_transmittance(FILE *out, const struct scene_model *model, const char *spans,
                                    const char *distance);
// Calls the integrator for `spans`; `stretch`: "origin, direction, interval", of Riemann sums without the interval.
void scene_glue_write_integrator(FILE *out, const struct scene_model *model, const char *stretch);
