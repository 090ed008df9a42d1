// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene_reader.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/scene/file_format.h"
#include "core/scene/input_path.h"

#include <stdlib.h>
#include <string.h>

static const size_t GRID_NAME_LIMIT = 255; // bytes; the limit of a NanoVDB file

const struct timeline_limits SCENE_POSITION = {.components = 3, .min = -1e9, .max = 1e9, .is_position = true};
const struct timeline_limits SCENE_DIRECTION = {.components = 3, .min = -1e9, .max = 1e9, .is_direction = true};
const struct timeline_limits SCENE_LENGTH = {.components = 1, .min = 0.0, .max = 1e9};
const struct timeline_limits SCENE_SIZE = {.components = 1, .min = 0.0, .max = 1e9, .excludes_min = true};
const struct timeline_limits SCENE_SIDES = {.components = 3, .min = 0.0, .max = 1e9, .excludes_min = true};
const struct timeline_limits SCENE_ANGLE = {.components = 1, .min = -1e9, .max = 1e9};
const struct timeline_limits SCENE_SCALE = {.components = 1, .min = 0.0, .max = 1e9};
const struct timeline_limits SCENE_SHARE = {.components = 1, .min = 0.0, .max = 1.0};
const struct timeline_limits SCENE_RADIANCE = {.min = 0.0, .max = 1e15};

bool scene_reader_has_key(const struct scene_reader *reader, const char *key)
{
    struct json_node node = json_node_child(reader->object, key);

    return !json_node_is_absent(&node);
}

bool scene_reader_read(const struct scene_reader *reader, const char *key, const struct timeline_limits *limits,
                       struct timeline *timeline)
{
    struct json_node node = json_node_child(reader->object, key);
    struct timeline_limits within = *limits;

    within.span = reader->span;
    return timeline_from_json(timeline, &node, &within, reader->error);
}

bool scene_reader_read_or(const struct scene_reader *reader, const char *key, const struct timeline_limits *limits,
                          double fallback, struct timeline *timeline)
{
    *timeline =
        (struct timeline){.component_count = limits->components == 3 ? 3 : 1, .value = {fallback, fallback, fallback}};
    return !scene_reader_has_key(reader, key) || scene_reader_read(reader, key, limits, timeline);
}

bool scene_reader_read_direction(const struct scene_reader *reader, const char *key, struct timeline *timeline)
{
    *timeline = (struct timeline){.component_count = 3, .value = {0.0, 1.0, 0.0}};
    return !scene_reader_has_key(reader, key) || scene_reader_read(reader, key, &SCENE_DIRECTION, timeline);
}

bool scene_reader_read_choice(const struct scene_reader *reader, const char *key, const char *const names[],
                              int *choice)
{
    struct json_node node = json_node_child(reader->object, key);

    return json_node_is_absent(&node) || json_read_enum(&node, names, choice, reader->error);
}

static bool fail_ending(const struct json_node *node, unsigned contents, struct error *error)
{
    char *endings = file_format_list_endings(contents, "or");
    char *expected = xasprintf("a name that ends in %s", endings);

    (void)json_fail_expected(node, error, expected);
    free(expected);
    free(endings);
    return false;
}

bool scene_reader_read_file(const struct scene_reader *reader, unsigned contents, char **path)
{
    struct json_node node = json_node_child(reader->object, "file");
    struct error cause = {0};
    const char *text;

    if (!json_read_string(&node, &text, reader->error)) return false;
    if (!input_path_check(text, &cause)) return json_fail(&node, reader->error, "%s", cause.message);
    if (!file_format_is(text, contents)) return fail_ending(&node, contents, reader->error);
    *path = xstrdup(text);
    return true;
}

bool scene_reader_read_grid_name(const struct scene_reader *reader, char **name)
{
    struct json_node node = json_node_child(reader->object, "grid");
    const char *text;

    *name = NULL;
    if (!json_read_string(&node, &text, reader->error)) return false;
    if (!*text || strlen(text) > GRID_NAME_LIMIT)
        return json_fail_expected(&node, reader->error, "the name of a grid, 1 to 255 bytes");
    *name = xstrdup(text);
    return true;
}
