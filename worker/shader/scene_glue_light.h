// Writes what of a scene's shader is about one light: its value and its samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdio.h>

struct scene_light;
struct scene_model;

// Writes the light as an expression: its structure, filled.
void scene_glue_light_write_value(FILE *out, const struct scene_light *light, size_t i);
// Writes `LightSample light_I(vec3 point)`, which is random for a sphere. For a dome `Spectrum light_I_radiance(vec3
// toward)` instead, and if it is an image `vec3 light_I_draw()`, random directions by its light, and `float
// light_I_density(vec3 toward)`, theirs per steradian.
void scene_glue_light_write_functions(FILE *out, const struct scene_light *light, size_t i);
// Writes the expression of the radiance that lies behind everything in a direction: the background, or a dome.
void scene_glue_light_write_behind(FILE *out, const struct scene_model *model, const char *direction);
// Writes the expression of light `i`'s sample in a march, and ";": for the whole segment where the light has a peak in
// it. Nodes of a Gauss rule follow 1 / r^2 by themselves, except where segments cannot be shortened further.
void scene_glue_light_write_sample(FILE *out, const struct scene_model *model, size_t i);
