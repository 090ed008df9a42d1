// Bounds that a job gives a density: their frame values and functions in a scene's shader.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct frame_uniforms;
struct scene_bounds;

// Returns the shader module of the bounds' kind; NULL for none.
const char *scene_bounds_module(const struct scene_bounds *bounds);
// Adds medium_I_bounds_center for any kind but none; medium_I_bounds_radius, _half_size, _normal, _half_thickness by
// kind; with a falloff medium_I_bounds_falloff. `bounds` outlives `uniforms`.
void scene_bounds_add_values(struct frame_uniforms *uniforms, const struct scene_bounds *bounds, size_t medium);
// Writes `vec2 medium_I_bounds_span(vec3 origin, vec3 direction)`, and with `has_falloff` `float medium_I_falloff(vec3
// p)`.
void scene_bounds_write(FILE *out, const struct scene_bounds *bounds, bool has_falloff, size_t medium);
