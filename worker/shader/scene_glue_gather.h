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
// Writes `float density_I` for each visible medium, from `MediaField field`.
void scene_glue_write_densities(FILE *out, const struct scene_model *model);
// Writes statements that add to `source` what media emit at `point`, per metre; with density_I and `field`.
void scene_glue_write_emitted(FILE *out, const struct scene_model *model);
// Writes `Spectrum scattered`: the scattering coefficient times the phase function from `light` to `direction`, summed
// over media; with density_I.
void scene_glue_write_scattered(FILE *out, const char *indent, const struct scene_model *model);
// Writes the integrator's call for `spans`. `stretch`: "origin, direction, interval", of Riemann sums without the
// interval.
void scene_glue_write_integrator(FILE *out, const struct scene_model *model, const char *stretch);
