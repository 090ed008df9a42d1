// SPDX-License-Identifier: Apache-2.0
#include "core/scene/light_rules.h"

#include "core/scene/file_format.h"
#include "core/scene/input_path.h"
#include "core/scene/scene_reader.h"

// A cone of half-angle 90 degrees is half of all directions.
static const struct timeline_limits INNER = {.components = 1, .min = 0.0, .max = 90.0};
static const struct timeline_limits OUTER = {.components = 1, .min = 0.0, .max = 90.0, .excludes_min = true};

static bool read_point(const struct scene_reader *reader, struct scene_light *light)
{
    static const char *const keys[] = {"kind", "falloff", "intensity", "position", NULL};
    static const char *const falloffs[] = {"inverse_square", "none", NULL};
    int choice = SCENE_FALLOFF_INVERSE_SQUARE;

    if (!json_check_keys(reader->object, keys, reader->error) ||
        !scene_reader_read_choice(reader, "falloff", falloffs, &choice))
        return false;
    light->falloff = (enum scene_falloff)choice;
    return scene_reader_read(reader, "intensity", &SCENE_RADIANCE, &light->intensity) &&
           scene_reader_read(reader, "position", &SCENE_POSITION, &light->position);
}

static bool read_sun(const struct scene_reader *reader, struct scene_light *light)
{
    static const char *const keys[] = {"kind", "intensity", "direction", NULL};

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read(reader, "intensity", &SCENE_RADIANCE, &light->intensity) &&
           scene_reader_read(reader, "direction", &SCENE_DIRECTION, &light->direction);
}

static bool read_spot(const struct scene_reader *reader, struct scene_light *light)
{
    static const char *const keys[] = {"kind", "intensity", "position", "direction", "inner", "outer", NULL};

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read(reader, "intensity", &SCENE_RADIANCE, &light->intensity) &&
           scene_reader_read(reader, "position", &SCENE_POSITION, &light->position) &&
           scene_reader_read(reader, "direction", &SCENE_DIRECTION, &light->direction) &&
           scene_reader_read(reader, "inner", &INNER, &light->inner) &&
           scene_reader_read(reader, "outer", &OUTER, &light->outer);
}

static bool read_sphere(const struct scene_reader *reader, struct scene_light *light)
{
    static const char *const keys[] = {"kind", "intensity", "position", "radius", NULL};

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read(reader, "intensity", &SCENE_RADIANCE, &light->intensity) &&
           scene_reader_read(reader, "position", &SCENE_POSITION, &light->position) &&
           scene_reader_read(reader, "radius", &SCENE_SIZE, &light->radius);
}

static bool read_gradient(const struct scene_reader *dome, struct scene_light *light)
{
    static const char *const keys[] = {"along", "against", "axis", NULL};
    struct json_node object = json_node_child(dome->object, "gradient");
    struct scene_reader reader = {&object, dome->span, dome->error};

    return json_check_object(&object, reader.error) && json_check_keys(&object, keys, reader.error) &&
           scene_reader_read(&reader, "along", &SCENE_RADIANCE, &light->intensity) &&
           scene_reader_read(&reader, "against", &SCENE_RADIANCE, &light->dome.opposite) &&
           scene_reader_read_direction(&reader, "axis", &light->dome.axis);
}

static bool read_turn(const struct scene_reader *dome, struct scene_light *light)
{
    static const char *const keys[] = {"axis", "angle", NULL};
    struct json_node object = json_node_child(dome->object, "rotate");
    struct scene_reader reader = {&object, dome->span, dome->error};

    if (json_node_is_absent(&object)) return true;
    return json_check_object(&object, reader.error) && json_check_keys(&object, keys, reader.error) &&
           scene_reader_read_direction(&reader, "axis", &light->dome.axis) &&
           scene_reader_read(&reader, "angle", &SCENE_ANGLE, &light->dome.angle);
}

static bool read_image(const struct scene_reader *reader, struct scene_light *light)
{
    struct json_node node = json_node_child(reader->object, "file");

    light->dome.image = (struct scene_texture){.is_linear = true, .is_radiance = true};
    if (!scene_reader_read_file(reader, FILE_IMAGE, &light->dome.image.file)) return false;
    if (!file_format_find(light->dome.image.file)->is_linear)
        return json_fail_expected(&node, reader->error, "a name that ends in .exr");
    if (input_path_is_sequence(light->dome.image.file))
        return json_fail(&node, reader->error, "expected one file, not one a frame");
    return scene_reader_read_or(reader, "scale", &SCENE_RADIANCE, 1.0, &light->intensity) && read_turn(reader, light);
}

static bool check_one_source(const struct scene_reader *dome)
{
    static const char *const numbers[] = {"none", "one", "two", "three"};
    int count = scene_reader_has_key(dome, "radiance") + scene_reader_has_key(dome, "gradient") +
                scene_reader_has_key(dome, "file");

    return count == 1 ||
           json_fail(dome->object, dome->error, "expected one of radiance, gradient and file, got %s", numbers[count]);
}

static bool read_dome(const struct scene_reader *reader, struct scene_light *light)
{
    static const char *const radiance_keys[] = {"kind", "radiance", "visible", NULL};
    static const char *const gradient_keys[] = {"kind", "gradient", "visible", NULL};
    static const char *const file_keys[] = {"kind", "file", "scale", "rotate", "visible", NULL};
    struct json_node visible = json_node_child(reader->object, "visible");

    light->dome.axis = (struct timeline){.component_count = 3, .value = {0.0, 1.0, 0.0}};
    light->dome.opposite = light->dome.angle = (struct timeline){.component_count = 1};
    if (!check_one_source(reader) ||
        (!json_node_is_absent(&visible) && !json_read_bool(&visible, &light->dome.is_visible, reader->error)))
        return false;
    if (scene_reader_has_key(reader, "file")) {
        light->dome.kind = SCENE_DOME_FILE;
        return json_check_keys(reader->object, file_keys, reader->error) && read_image(reader, light);
    }
    if (scene_reader_has_key(reader, "gradient")) {
        light->dome.kind = SCENE_DOME_GRADIENT;
        return json_check_keys(reader->object, gradient_keys, reader->error) && read_gradient(reader, light);
    }
    light->dome.kind = SCENE_DOME_RADIANCE;
    return json_check_keys(reader->object, radiance_keys, reader->error) &&
           scene_reader_read(reader, "radiance", &SCENE_RADIANCE, &light->intensity);
}

static const struct light_rules rules[] = {
    [SCENE_LIGHT_POINT] = {"point", "a point light", .has_position = true, .read = read_point},
    [SCENE_LIGHT_SUN] = {"sun", "a sun", .has_direction = true, .read = read_sun},
    [SCENE_LIGHT_SPOT] = {"spot", "a spot", .has_position = true, .has_direction = true, .read = read_spot},
    [SCENE_LIGHT_SPHERE] = {"sphere", "a sphere", .has_position = true, .has_size = true, .read = read_sphere},
    [SCENE_LIGHT_DOME] = {"dome", "a dome", .has_size = true, .read = read_dome},
};

enum { COUNT = sizeof rules / sizeof rules[0] };
_Static_assert((int)COUNT < (int)LIGHT_RULES_LIMIT, "a list has room for all names and NULL");

const struct light_rules *light_rules_of(enum scene_light_kind kind)
{
    return &rules[kind];
}

void light_rules_list(const char *names[static LIGHT_RULES_LIMIT])
{
    for (int i = 0; i < COUNT; i++)
        names[i] = rules[i].name;
    names[COUNT] = NULL;
}
