// Kinds of lights, as they enter a scene's shader: a row a kind.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>

struct frame_uniforms;

// docs/architecture.md has the recipe of a new kind: a row in light_kind.c, its module, and what tells lights apart.
struct light_kind {
    const char *module;     // below shaders/
    const char *call;       // the function and its struct, up to the struct's first member, which is the intensity
    const char *value;      // the second member: the frame value light_I_VALUE
    bool takes_point;       // the function's last parameter is the point that is lit
    bool is_inverse_square; // its irradiance falls with the square of the distance
    void (*add_value)(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index);
};

const struct light_kind *light_kind_of(const struct scene_light *light);
// Adds light_I_position, for kinds that have one.
void light_kind_add_position(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index);
