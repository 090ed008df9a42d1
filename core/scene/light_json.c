// SPDX-License-Identifier: Apache-2.0
#include "core/scene/light_json.h"

#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

static bool read_point_light(const struct scene_reader *reader, struct scene_light *light)
{
    static const char *const keys[] = {"kind", "falloff", "intensity", "position", NULL};
    static const char *const falloffs[] = {"inverse_square", "none", NULL};
    int choice = SCENE_FALLOFF_INVERSE_SQUARE;

    if (!json_check_keys(reader->object, keys, reader->error) ||
        !scene_reader_read_choice(reader, "falloff", falloffs, &choice))
        return false;
    light->falloff = (enum scene_falloff)choice;
    light->direction = (struct timeline){.component_count = 3};
    return scene_reader_read(reader, "intensity", &SCENE_RADIANCE, &light->intensity) &&
           scene_reader_read(reader, "position", &SCENE_POSITION, &light->position);
}

static bool read_sun_light(const struct scene_reader *reader, struct scene_light *light)
{
    static const char *const keys[] = {"kind", "intensity", "direction", NULL};

    light->position = (struct timeline){.component_count = 3};
    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read(reader, "intensity", &SCENE_RADIANCE, &light->intensity) &&
           scene_reader_read(reader, "direction", &SCENE_DIRECTION, &light->direction);
}

static const struct {
    const char *name; // in the job
    bool (*read)(const struct scene_reader *reader, struct scene_light *light);
} kinds[] = {
    [SCENE_LIGHT_POINT] = {"point", read_point_light},
    [SCENE_LIGHT_SUN] = {"sun", read_sun_light},
};

enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

static bool read_light(const struct scene_reader *reader, struct scene_light *light)
{
    struct json_node kind = json_node_child(reader->object, "kind");
    const char *names[KIND_COUNT + 1] = {NULL};
    int choice;

    for (int i = 0; i < KIND_COUNT; i++)
        names[i] = kinds[i].name;
    if (!json_check_object(reader->object, reader->error) || !json_read_enum(&kind, names, &choice, reader->error))
        return false;
    light->kind = (enum scene_light_kind)choice;
    return kinds[choice].read(reader, light);
}

bool lights_from_json(struct scene *scene, const struct scene_reader *job)
{
    struct json_node lights = json_node_child(job->object, "lights"), light = {0};
    struct scene_reader reader = {&light, job->span, job->error};

    if (json_node_is_absent(&lights)) return true;
    if (!json_check_array(&lights, 0, SCENE_LIGHT_LIMIT, job->error)) return false;
    while (json_node_next(&lights, &light))
        if (!read_light(&reader, &scene->lights[scene->light_count++])) return false;
    return true;
}
