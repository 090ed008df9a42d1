// Reads a density that the user wrote in GLSL.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_glsl;
struct scene_reader;

// `reader` stands at the density; `glsl` is empty. On failure the caller still calls scene_finish.
bool glsl_from_json(struct scene_glsl *glsl, const struct scene_reader *reader);
