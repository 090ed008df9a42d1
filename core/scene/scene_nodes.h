// Finds the parts of a scene in its job's document.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"

#include <stddef.h>

struct scene;

// A node and its parents. They point to each other, so the struct must not be copied.
struct scene_nodes {
    struct json_node scene, list, object, inner, last;
};

// The medium scene->media[index]: an element of scene.media, or the interior of an object. Lives as long as `nodes` and
// `document`, the job's root.
const struct json_node *scene_nodes_find_medium(struct scene_nodes *nodes, const struct json_node *document,
                                                const struct scene *scene, size_t index);
// The shape `member` of scene->objects[index]: the object itself, or an element of its union.
const struct json_node *scene_nodes_find_shape(struct scene_nodes *nodes, const struct json_node *document,
                                               const struct scene *scene, size_t index, size_t member);
// The material of scene->objects[index].
const struct json_node *scene_nodes_find_material(struct scene_nodes *nodes, const struct json_node *document,
                                                  size_t index);
