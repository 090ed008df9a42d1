// Frame values of a scene's shader, and how each follows from the job.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/glsl/frame_uniforms.h"

#include <stddef.h>

struct job;
struct scene_model;

// Adds for the visible parts: camera_position, _corner, _across, _down; background; time_s; the values of each
// density's kind and bounds; scene_anchor where some density takes it; the values of object_values_add;
// medium_I_sigma_s, _sigma_t, _emission, _lobe_J_g, _lobe_J_weight; light_I_intensity, _position, _direction (towards
// the sun). The model's job and inputs outlive `uniforms`.
void scene_values_add(struct frame_uniforms *uniforms, const struct scene_model *model);
// Adds only time_s where some visible medium takes it, and the values of the densities and bounds of visible media.
void scene_values_add_densities(struct frame_uniforms *uniforms, const struct scene_model *model);
