// The meaning of a grid's values, dense or sparse: a density, or the argument of a transfer function.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/density/density_kind.h"
#include "worker/volume/volume_voxels.h"

// As in density_kind.
bool grid_lookup_is_zero(const struct scene_density *density);
bool grid_lookup_has_color(const struct scene_density *density);
// Returns the prefix of GLSL's sampler2DArray for a grid of this type: "u", "i" or nothing.
const char *grid_lookup_sampler_prefix(enum volume_type type);
// Evaluates the linear map from the world to voxels, column-major, without the shift. `source` is a scene_input.
void grid_lookup_evaluate_to_voxels(const void *source, double time, double value[static 9]);
// True when the grid stays at its file's position.
bool grid_lookup_is_still(const struct scene_grid *grid);
// Adds medium_I_unit_distance or medium_I_scale.
void grid_lookup_add_values(struct frame_uniforms *uniforms, const struct density_site *site);
// Writes for a transfer function medium_I_opacity and _rgb of a value, and medium_I_density and _color of a field whose
// x is an opacity and z the value.
void grid_lookup_write_transfer(FILE *out, const struct scene_grid *grid, size_t i);
// Writes for a table of the transfer function, at MEDIUM_TEXTURE_EXTRA: medium_I_end_at, medium_I_position of a value,
// and medium_I_density and _color of a mean.
void grid_lookup_write_table(FILE *out, const struct scene_grid *grid, size_t i);
