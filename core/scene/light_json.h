// Reads the lights of a job.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene;
struct scene_reader;

// `job` stands at an object whose key "lights" is read; absent: none. On failure the caller still calls scene_finish.
bool lights_from_json(struct scene *scene, const struct scene_reader *job);
