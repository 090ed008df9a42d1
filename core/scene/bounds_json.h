// Reads the bounds of a density.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_bounds;
struct scene_reader;

// `density` stands at an object whose key "bounds" is read; absent: none.
bool bounds_from_json(struct scene_bounds *bounds, const struct scene_reader *density);
