// Reads camera, lights, background, media and objects from a job document.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"
#include "core/scene/timeline.h"

#include <stdbool.h>

struct scene;

// The times at which values are needed.
struct scene_times {
    struct timeline_span frames; // from the first frame to the last
    double frame_s;              // from one frame to the next
};

// `job` is the document's root object; its keys camera, lights, background and scene are read. Lights, media and
// objects may be absent. Ranges of values are checked from the first frame to the end of the shutter of the last. On
// failure the caller still calls scene_finish.
bool scene_from_json(struct scene *scene, const struct json_node *job, const struct scene_times *times,
                     struct error *error);
