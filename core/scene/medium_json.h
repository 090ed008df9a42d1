// Reads a medium: its density, its coefficients and its phase function.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_medium;
struct scene_reader;

// `reader` stands at the medium. On failure the caller still calls scene_finish.
bool medium_from_json(struct scene_medium *medium, const struct scene_reader *reader);
// Reads the medium that fills an object. An absent density is homogeneous, 1 everywhere.
bool medium_interior_from_json(struct scene_medium *medium, const struct scene_reader *reader);
