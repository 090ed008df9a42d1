// SPDX-License-Identifier: Apache-2.0
#include "core/scene/light_json.h"

#include "core/scene/light_rules.h"
#include "core/scene/scene_reader.h"

static bool read_light(const struct scene_reader *reader, struct scene_light *light)
{
    struct json_node kind = json_node_child(reader->object, "kind");
    const char *names[LIGHT_RULES_LIMIT];
    int choice;

    light_rules_list(names);
    if (!json_check_object(reader->object, reader->error) || !json_read_enum(&kind, names, &choice, reader->error))
        return false;
    light->kind = (enum scene_light_kind)choice;
    light->position = light->direction = (struct timeline){.component_count = 3};
    return light_rules_of(light->kind)->read(reader, light);
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
