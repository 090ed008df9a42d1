// Reads the density of a medium, of any kind, and its bounds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_density;
struct scene_reader;

// `medium` stands at an object whose key "density" is read. On failure the caller still calls scene_finish.
bool density_from_json(struct scene_density *density, const struct scene_reader *medium);
