// Reads the blackbody emission of a medium.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_blackbody;
struct scene_density;
struct scene_reader;

// `medium` stands at an object whose key "blackbody" is read; absent: none. `density` is that of the medium and has
// been read.
bool blackbody_from_json(struct scene_blackbody *blackbody, const struct scene_reader *medium,
                         const struct scene_density *density);
