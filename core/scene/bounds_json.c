// SPDX-License-Identifier: Apache-2.0
#include "core/scene/bounds_json.h"

#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

static bool read_sphere(const struct scene_reader *reader, struct scene_bounds *bounds)
{
    static const char *const keys[] = {"kind", "center", "radius", "falloff", NULL};

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read(reader, "radius", &SCENE_SIZE, &bounds->radius);
}

static bool read_box(const struct scene_reader *reader, struct scene_bounds *bounds)
{
    static const char *const keys[] = {"kind", "center", "size", "falloff", NULL};

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read(reader, "size", &SCENE_SIDES, &bounds->size);
}

static bool read_slab(const struct scene_reader *reader, struct scene_bounds *bounds)
{
    static const char *const keys[] = {"kind", "center", "normal", "thickness", "falloff", NULL};

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read_direction(reader, "normal", &bounds->normal) &&
           scene_reader_read(reader, "thickness", &SCENE_SIZE, &bounds->thickness);
}

static bool read_kind(const struct scene_reader *reader, struct scene_bounds *bounds)
{
    static const char *const kinds[] = {"sphere", "box", "slab", NULL};
    struct json_node kind = json_node_child(reader->object, "kind");
    int choice;

    if (!json_read_enum(&kind, kinds, &choice, reader->error)) return false;
    switch (choice) {
    case 0:
        bounds->kind = SCENE_BOUNDS_SPHERE;
        return read_sphere(reader, bounds);
    case 1:
        bounds->kind = SCENE_BOUNDS_BOX;
        return read_box(reader, bounds);
    default:
        bounds->kind = SCENE_BOUNDS_SLAB;
        return read_slab(reader, bounds);
    }
}

bool bounds_from_json(struct scene_bounds *bounds, const struct scene_reader *density)
{
    struct json_node object = json_node_child(density->object, "bounds");
    struct scene_reader reader = {&object, density->span, density->error};

    *bounds = (struct scene_bounds){0};
    if (json_node_is_absent(&object)) return true;
    return json_check_object(&object, reader.error) && read_kind(&reader, bounds) &&
           scene_reader_read_or(&reader, "center", &SCENE_POSITION, 0.0, &bounds->center) &&
           scene_reader_read_or(&reader, "falloff", &SCENE_LENGTH, 0.0, &bounds->falloff);
}
