// Reads camera, lights and media from a job document.
#pragma once

#include "core/json_read.h"

#include <stdbool.h>

struct scene;
struct timeline;

// `job` is the document's root object; its keys camera, lights, background and scene are read. Lights and media may be
// absent. On failure the caller still calls scene_finish.
bool scene_from_json(struct scene *scene, const struct json_node *job, struct error *error);

// `components`: 1 a number, 3 a vector, 0 either (a number or [r, g, b]). `min` and `max` bound constants and keys; a
// lissajous is bounded by center -+ amplitude; linear is checked for finiteness only.
bool timeline_from_json(struct timeline *timeline, const struct json_node *node, int components, double min, double max,
                        struct error *error);
