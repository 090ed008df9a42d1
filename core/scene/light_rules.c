// SPDX-License-Identifier: Apache-2.0
#include "core/scene/light_rules.h"

#include "core/scene/scene_reader.h"

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

static const struct light_rules rules[] = {
    [SCENE_LIGHT_POINT] = {"point", "a point light", .has_position = true, .read = read_point},
    [SCENE_LIGHT_SUN] = {"sun", "a sun", .has_direction = true, .read = read_sun},
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
