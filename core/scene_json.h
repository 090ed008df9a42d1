// Reads camera, lights, background and media from a job document.
#pragma once

#include "core/json_read.h"
#include "core/timeline.h"

#include <stdbool.h>

struct scene;

// `job` is the document's root object; its keys camera, lights, background and scene are read. Lights and media may be
// absent. `span` holds the times of all frames: values are checked between them. On failure the caller still calls
// scene_finish.
bool scene_from_json(struct scene *scene, const struct json_node *job, struct timeline_span span, struct error *error);
