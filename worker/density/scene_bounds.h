// The bounds that a job gives a density: its numbers and functions in a scene's shader.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct frame_uniforms;
struct scene_bounds;

// The shader module of its kind; NULL for none.
const char *scene_bounds_module(const struct scene_bounds *bounds);
// For any kind but none medium_I_bounds_center; medium_I_bounds_radius, _half_size, _normal, _half_thickness by kind; with
// a falloff medium_I_bounds_falloff. `bounds` outlives `uniforms`.
void scene_bounds_add_values(struct frame_uniforms *uniforms, const struct scene_bounds *bounds, size_t medium);
// `vec2 medium_I_bounds_span(vec3 origin, vec3 direction)`, and with `has_falloff` `float medium_I_falloff(vec3 p)`.
void scene_bounds_write(FILE *out, const struct scene_bounds *bounds, bool has_falloff, size_t medium);
