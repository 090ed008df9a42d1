// Reads the light of a hot grid.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_blackbody;
struct scene_density;
struct scene_reader;

// `medium` stands at an object whose key "blackbody" is read; absent: none. `density` is the medium's own, read already.
bool blackbody_from_json(struct scene_blackbody *blackbody, const struct scene_reader *medium,
                         const struct scene_density *density);
