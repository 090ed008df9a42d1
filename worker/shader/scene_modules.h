// Adds the shader modules that a scene's densities, phases and lights need.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct scene_model;
struct shader_assembly;

void scene_modules_add_density(struct shader_assembly *text, const struct scene_model *model, size_t medium);
// Adds the phase functions of all media that scatter, and the kinds of visible lights.
void scene_modules_add_lights(struct shader_assembly *text, const struct scene_model *model);
// Adds the modules that draw directions from the phase functions of all media that scatter.
void scene_modules_add_draws(struct shader_assembly *text, const struct scene_model *model);
