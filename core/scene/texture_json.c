// SPDX-License-Identifier: Apache-2.0
#include "core/scene/texture_json.h"

#include "core/scene/file_format.h"
#include "core/scene/input_path.h"
#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

static const double TILE_MIN = 1e-9, TILE_MAX = 1e9; // m

static bool read_file(const struct scene_reader *reader, struct scene_texture *texture)
{
    struct json_node node = json_node_child(reader->object, "file");

    if (!scene_reader_read_file(reader, FILE_IMAGE, &texture->file)) return false;
    return !input_path_is_sequence(texture->file) ||
           json_fail(&node, reader->error, "expected one file, not one a frame");
}

static bool read_size(const struct scene_reader *reader, struct scene_texture *texture, bool has_size)
{
    struct json_node node = json_node_child(reader->object, "size");

    if (!has_size)
        return json_node_is_absent(&node) ||
               json_fail(&node, reader->error, "not on spheres: a texture goes around them once");
    if (json_node_type(&node) == JSON_NUMBER)
        return json_read_number(&node, TILE_MIN, TILE_MAX, &texture->size[0], reader->error);
    if (json_node_type(&node) != JSON_ARRAY || json_node_count(&node) != 2)
        return json_fail_expected(&node, reader->error, "a tile's size in metres, a number or [across, up]");
    for (size_t i = 0; i < 2; i++) {
        struct json_node side = json_node_element(&node, i);

        if (!json_read_number(&side, TILE_MIN, TILE_MAX, &texture->size[i], reader->error)) return false;
    }
    return true;
}

bool texture_from_json(struct scene_texture *texture, const struct scene_reader *material, bool has_size)
{
    static const char *const keys[] = {"file", "size", "filter", "color_space", NULL};
    static const char *const filters[] = {"linear", "nearest", NULL};
    static const char *const color_spaces[] = {"srgb", "linear", NULL};
    struct json_node object = json_node_child(material->object, "texture");
    struct scene_reader reader = {&object, material->span, material->error};
    int filter = 0, color_space;

    if (json_node_is_absent(&object)) return true;
    if (!json_check_object(&object, reader.error) || !json_check_keys(&object, keys, reader.error) ||
        !read_file(&reader, texture) || !read_size(&reader, texture, has_size))
        return false;
    color_space = file_format_find(texture->file)->is_linear ? 1 : 0;
    if (!scene_reader_read_choice(&reader, "filter", filters, &filter) ||
        !scene_reader_read_choice(&reader, "color_space", color_spaces, &color_space))
        return false;
    texture->is_nearest = filter == 1;
    texture->is_linear = color_space == 1;
    return true;
}
