// Kinds of lights, as they enter a scene's shader: a row a kind.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"
#include "worker/glsl/frame_uniforms.h"

#include <stdbool.h>

enum { LIGHT_VALUE_LIMIT = 4, LIGHT_MODULE_LIMIT = 4 };

// A light of a scene's shader.
struct light_site {
    const struct scene_light *light;
    size_t index;
    enum frame_value_type spectrum; // of its colours
};

struct light_value {
    const char *name; // the frame value is light_I_NAME
    void (*add)(struct frame_uniforms *uniforms, const struct light_site *site);
};

// A new kind is a row in light_kind.c, its module, and what core/scene/light_rules.c says of it.
struct light_kind {
    const char *modules[LIGHT_MODULE_LIMIT]; // below shaders/
    const char *structure;                   // whose first member is the intensity
    const char *function;                    // of its sample; of a dome what its functions' names begin with
    const struct light_value *values[LIGHT_VALUE_LIMIT]; // the other members
    bool is_inverse_square; // its irradiance is LightPoint's; else write_placed_scattering takes it for the intensity
    bool is_spot;           // the same, times light_spot_share
    bool is_sphere;         // its samples are random
    bool is_dome;
    bool has_image; // a dome's
};

const struct light_kind *light_kind_of(const struct scene_light *light);
// True when it never shines.
bool light_kind_is_dark(const struct scene_light *light);
// True when its light is grey at all times.
bool light_kind_is_grey(const struct scene_light *light);
// Adds the frame values of its kind, without the intensity.
void light_kind_add_values(struct frame_uniforms *uniforms, const struct light_site *site);
// Adds light_I_position, for kinds that have one.
void light_kind_add_position(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index);
