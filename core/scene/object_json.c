// SPDX-License-Identifier: Apache-2.0
#include "core/scene/object_json.h"

#include "core/scene/material_json.h"
#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

// The first of `keys` is not allowed in a member of a union.
static bool check_keys(const struct scene_reader *reader, const char *const keys[], bool is_member)
{
    return json_check_keys(reader->object, keys + (is_member ? 1 : 0), reader->error);
}

static bool read_sphere(const struct scene_reader *reader, struct scene_shape *shape, bool is_member)
{
    static const char *const keys[] = {"material", "kind", "center", "radius", NULL};

    return check_keys(reader, keys, is_member) &&
           scene_reader_read(reader, "center", &SCENE_POSITION, &shape->center) &&
           scene_reader_read(reader, "radius", &SCENE_SIZE, &shape->radius);
}

static bool read_box(const struct scene_reader *reader, struct scene_shape *shape, bool is_member)
{
    static const char *const keys[] = {"material", "kind", "center", "size", NULL};

    return check_keys(reader, keys, is_member) &&
           scene_reader_read(reader, "center", &SCENE_POSITION, &shape->center) &&
           scene_reader_read(reader, "size", &SCENE_SIDES, &shape->size);
}

static bool read_plane(const struct scene_reader *reader, struct scene_shape *shape, bool is_member)
{
    static const char *const keys[] = {"material", "kind", "point", "normal", NULL};

    return check_keys(reader, keys, is_member) && scene_reader_read(reader, "point", &SCENE_POSITION, &shape->center) &&
           scene_reader_read_direction(reader, "normal", &shape->normal);
}

static bool add_shape(struct scene *scene, enum scene_shape_kind kind, const struct scene_reader *reader,
                      bool is_member)
{
    struct scene_shape *shape = &scene->shapes[scene->shape_count];

    if (scene->shape_count == SCENE_SHAPE_LIMIT)
        return json_fail(reader->object, reader->error, "expected at most %d shapes in all", SCENE_SHAPE_LIMIT);
    scene->shape_count++;
    scene->objects[scene->object_count - 1].shape_count++;
    // Values that the kind does not have are set too.
    *shape = (struct scene_shape){.kind = kind,
                                  .center = {.component_count = 3},
                                  .radius = {.component_count = 1},
                                  .size = {.component_count = 3},
                                  .normal = {.component_count = 3, .value = {0.0, 1.0, 0.0}}};
    switch (kind) {
    case SCENE_SHAPE_SPHERE:
        return read_sphere(reader, shape, is_member);
    case SCENE_SHAPE_BOX:
        return read_box(reader, shape, is_member);
    case SCENE_SHAPE_PLANE:
        return read_plane(reader, shape, is_member);
    }
    return false;
}

static bool read_union(struct scene *scene, const struct scene_reader *object_reader)
{
    static const char *const keys[] = {"material", "kind", "of", NULL};
    static const char *const kinds[] = {"sphere", "box", "plane", NULL}; // in the order of enum scene_shape_kind
    struct json_node shapes = json_node_child(object_reader->object, "of"), shape = {0};
    struct scene_reader reader = {&shape, object_reader->span, object_reader->error};

    if (!json_check_keys(object_reader->object, keys, reader.error) ||
        !json_check_array(&shapes, 1, SCENE_SHAPE_LIMIT, reader.error))
        return false;
    while (json_node_next(&shapes, &shape)) {
        struct json_node kind = json_node_child(&shape, "kind");
        int choice;

        if (!json_check_object(&shape, reader.error) || !json_read_enum(&kind, kinds, &choice, reader.error) ||
            !add_shape(scene, (enum scene_shape_kind)choice, &reader, true))
            return false;
    }
    return true;
}

static bool read_object(struct scene *scene, const struct scene_reader *reader)
{
    static const char *const kinds[] = {"sphere", "box", "plane", "union",
                                        NULL}; // as enum scene_shape_kind, and "union"
    struct json_node kind = json_node_child(reader->object, "kind");
    struct scene_object *object = &scene->objects[scene->object_count++];
    int choice;

    *object = (struct scene_object){.first_shape = scene->shape_count};
    if (!json_check_object(reader->object, reader->error) || !json_read_enum(&kind, kinds, &choice, reader->error))
        return false;
    object->is_union = choice == SCENE_SHAPE_PLANE + 1;
    return (object->is_union ? read_union(scene, reader)
                             : add_shape(scene, (enum scene_shape_kind)choice, reader, false)) &&
           material_from_json(scene, scene->object_count - 1, reader);
}

bool objects_from_json(struct scene *scene, const struct scene_reader *scene_reader)
{
    struct json_node objects = json_node_child(scene_reader->object, "objects"), object = {0};
    struct scene_reader reader = {&object, scene_reader->span, scene_reader->error};

    if (json_node_is_absent(&objects)) return true;
    if (!json_check_array(&objects, 0, SCENE_OBJECT_LIMIT, reader.error)) return false;
    while (json_node_next(&objects, &object))
        if (!read_object(scene, &reader)) return false;
    return true;
}
