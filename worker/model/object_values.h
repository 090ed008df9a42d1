// Frame values of the objects of a scene's shader, and how each follows from the job.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/glsl/frame_uniforms.h"

struct scene;
struct scene_features;

// Adds shape_I_center; shape_I_radius, _half_size or _normal, by kind; and those of object_I_albedo, _specular,
// _reflectance, _ior, _f0, _f90, _roughness that the features use. `scene` outlives `uniforms`.
void object_values_add(struct frame_uniforms *uniforms, const struct scene *scene,
                       const struct scene_features *features, enum frame_value_type spectrum);
