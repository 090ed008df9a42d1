// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene_nodes.h"

#include "core/scene/scene.h"

static void find_element(struct scene_nodes *nodes, const struct json_node *document, const char *list, size_t index)
{
    nodes->scene = json_node_child(document, "scene");
    nodes->list = json_node_child(&nodes->scene, list);
    nodes->object = json_node_element(&nodes->list, index);
}

const struct json_node *scene_nodes_find_medium(struct scene_nodes *nodes, const struct json_node *document,
                                                const struct scene *scene, size_t index)
{
    size_t owner = scene->media[index].owner;

    if (owner == 0) {
        find_element(nodes, document, "media", index); // interiors follow these
        return &nodes->object;
    }
    find_element(nodes, document, "objects", owner - 1);
    nodes->inner = json_node_child(&nodes->object, "material");
    nodes->last = json_node_child(&nodes->inner, "interior");
    return &nodes->last;
}

const struct json_node *scene_nodes_find_shape(struct scene_nodes *nodes, const struct json_node *document,
                                               const struct scene *scene, size_t index, size_t member)
{
    find_element(nodes, document, "objects", index);
    if (!scene->objects[index].is_union) return &nodes->object;
    nodes->inner = json_node_child(&nodes->object, "of");
    nodes->last = json_node_element(&nodes->inner, member);
    return &nodes->last;
}

const struct json_node *scene_nodes_find_material(struct scene_nodes *nodes, const struct json_node *document,
                                                  size_t index)
{
    find_element(nodes, document, "objects", index);
    nodes->inner = json_node_child(&nodes->object, "material");
    return &nodes->inner;
}
