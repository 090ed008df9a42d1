// Reads a medium: its density, what it does to light, and its phase function.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_medium;
struct scene_reader;

// `reader` stands at the medium. On failure the caller still calls scene_finish.
bool medium_from_json(struct scene_medium *medium, const struct scene_reader *reader);
// The same of what fills an object: without a density it is homogeneous, 1 everywhere.
bool medium_interior_from_json(struct scene_medium *medium, const struct scene_reader *reader);
