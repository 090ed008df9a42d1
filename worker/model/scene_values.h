// Which numbers a scene's shader needs, and how each follows from the job.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/glsl/frame_uniforms.h"

#include <stddef.h>

struct job;
struct scene_model;

// Adds, for what is seen: camera_position, _corner, _across, _down; background; time_s; what each density's kind and bounds
// add; scene_anchor where some density takes it; what object_values_add adds; medium_I_sigma_s, _sigma_t, _emission, _lobe_J_g, _lobe_J_weight; light_I_intensity, _position, _direction (towards
// the sun). The model's job and inputs outlive `uniforms`.
void scene_values_add(struct frame_uniforms *uniforms, const struct scene_model *model);
// Of these, time_s where some seen medium takes it, and what the densities and bounds of seen media add.
void scene_values_add_densities(struct frame_uniforms *uniforms, const struct scene_model *model);
