// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_rules.h"

#include "core/base/alloc.h"
#include "core/base/hash_text.h"
#include "core/scene/file_format.h"
#include "core/scene/input_path.h"
#include "core/scene/scene_reader.h"

#include <inttypes.h>
#include <stdlib.h>

static const double SPACING_MIN = 1e-9, SPACING_MAX = 1e9; // m
static const double VALUE_MAX = 1e15;
static const double OPACITY_MAX = 1.0 - 1e-6;
static const int64_t SKIP_MAX = INT64_C(1) << 50; // bytes

static bool read_grid_name(const struct scene_reader *reader, struct scene_grid *grid)
{
    struct json_node node = json_node_child(reader->object, "grid");
    char *endings;

    if (json_node_is_absent(&node)) return true;
    if (!scene_reader_read_grid_name(reader, &grid->grid_name)) return false;
    if (scene_grid_is_sparse(grid)) return true;
    endings = file_format_list_endings(FILE_GRID_SPARSE, "and");
    (void)json_fail(&node, reader->error, "only %s files have named grids", endings);
    free(endings);
    return false;
}

static bool read_size(const struct scene_reader *reader, struct scene_raw *raw)
{
    struct json_node node = json_node_child(reader->object, "size");

    if (json_node_is_absent(&node)) return true;
    if (json_node_type(&node) != JSON_ARRAY || json_node_count(&node) != 3)
        return json_fail_expected(&node, reader->error, "[width, height, depth] in voxels");
    for (size_t i = 0; i < 3; i++) {
        struct json_node side = json_node_element(&node, i);
        int64_t count;

        if (!json_read_integer(&side, 1, SCENE_GRID_SIDE_LIMIT, &count, reader->error)) return false;
        raw->size[i] = (int)count;
    }
    return true;
}

static bool read_raw(const struct scene_reader *reader, struct scene_grid *grid)
{
    static const char *const raw_keys[] = {"size", "type", "byte_order", "skip_bytes"};
    static const char *const types[] = {"uint8", "uint16", "int16", "float32", NULL};
    static const char *const orders[] = {"little", "big", NULL};
    struct json_node skip = json_node_child(reader->object, "skip_bytes");
    int type = 0, order = 0;

    for (size_t i = 0; i < sizeof raw_keys / sizeof raw_keys[0]; i++) {
        struct json_node node = json_node_child(reader->object, raw_keys[i]);

        if (!json_node_is_absent(&node) && !file_format_is(grid->file, FILE_GRID_RAW))
            return json_fail(&node, reader->error, "only for .raw files; the headers of others have it");
    }
    grid->raw.has_type = scene_reader_has_key(reader, "type");
    if (!read_size(reader, &grid->raw) || !scene_reader_read_choice(reader, "type", types, &type) ||
        !scene_reader_read_choice(reader, "byte_order", orders, &order) ||
        (!json_node_is_absent(&skip) && !json_read_integer(&skip, 0, SKIP_MAX, &grid->raw.skip_bytes, reader->error)))
        return false;
    grid->raw.type = (enum scene_voxel)type;
    grid->raw.is_big_endian = order == 1;
    return true;
}

static bool read_spacing(const struct scene_reader *reader, struct scene_grid *grid)
{
    struct json_node node = json_node_child(reader->object, "spacing");

    if (json_node_is_absent(&node)) return true;
    if (json_node_type(&node) != JSON_ARRAY || json_node_count(&node) != 3)
        return json_fail_expected(&node, reader->error, "[x, y, z], the sides of a voxel in metres");
    for (size_t i = 0; i < 3; i++) {
        struct json_node side = json_node_element(&node, i);

        if (!json_read_number(&side, SPACING_MIN, SPACING_MAX, &grid->spacing[i], reader->error)) return false;
    }
    return true;
}

static bool read_point(const struct json_node *node, struct scene_transfer_point *point, struct error *error)
{
    struct json_node value = json_node_element(node, 0), opacity = json_node_element(node, 4);

    if (json_node_type(node) != JSON_ARRAY || json_node_count(node) != 5)
        return json_fail_expected(node, error, "[value, r, g, b, a]");
    if (!json_read_number(&value, -VALUE_MAX, VALUE_MAX, &point->value, error)) return false;
    for (size_t i = 0; i < 3; i++) {
        struct json_node colour = json_node_element(node, 1 + i);

        if (!json_read_number(&colour, 0.0, VALUE_MAX, &point->rgba[i], error)) return false;
    }
    return json_read_number(&opacity, 0.0, OPACITY_MAX, &point->rgba[3], error);
}

static bool read_transfer_function(const struct scene_reader *reader, struct scene_grid *grid)
{
    struct json_node list = json_node_child(reader->object, "transfer_function"), child = {0};
    struct json_node unit_distance = json_node_child(reader->object, "unit_distance");
    struct json_node scale = json_node_child(reader->object, "scale");

    if (json_node_is_absent(&list))
        return json_node_is_absent(&unit_distance) ||
               json_fail(&unit_distance, reader->error, "only beside a transfer_function");
    if (!json_node_is_absent(&scale))
        return json_fail(&scale, reader->error, "not beside a transfer_function, which says what a value means");
    if (!json_check_array(&list, 2, SCENE_TRANSFER_LIMIT, reader->error)) return false;
    grid->points = xcalloc(json_node_count(&list), sizeof *grid->points);
    while (json_node_next(&list, &child)) {
        struct scene_transfer_point *point = &grid->points[grid->point_count];
        struct json_node value = json_node_element(&child, 0);

        if (!read_point(&child, point, reader->error)) return false;
        if (grid->point_count > 0 && point->value <= point[-1].value)
            return json_fail(&value, reader->error,
                             "expected a value above that of the point before it (%.10g), got %.10g", point[-1].value,
                             point->value);
        grid->point_count++;
    }
    return scene_reader_read(reader, "unit_distance", &SCENE_SIZE, &grid->unit_distance);
}

static bool read(struct scene_density *density, const struct scene_reader *reader)
{
    static const char *const keys[] = {"kind",
                                       "bounds",
                                       "file",
                                       "grid",
                                       "size",
                                       "type",
                                       "byte_order",
                                       "skip_bytes",
                                       "spacing",
                                       "interpolation",
                                       "center",
                                       "scale",
                                       "transfer_function",
                                       "unit_distance",
                                       NULL};
    static const char *const interpolations[] = {"linear", "nearest", NULL};
    struct scene_grid *grid = &density->grid;
    int interpolation = 0;

    if (!json_check_keys(reader->object, keys, reader->error) ||
        !scene_reader_read_file(reader, FILE_GRID_RAW | FILE_GRID_DENSE | FILE_GRID_SPARSE, &grid->file) ||
        !read_grid_name(reader, grid) || !read_raw(reader, grid) || !read_spacing(reader, grid) ||
        !scene_reader_read_choice(reader, "interpolation", interpolations, &interpolation))
        return false;
    grid->is_nearest = interpolation == 1;
    grid->has_center = scene_reader_has_key(reader, "center");
    return scene_reader_read_or(reader, "center", &SCENE_POSITION, 0.0, &grid->center) &&
           read_transfer_function(reader, grid) &&
           scene_reader_read_or(reader, "scale", &SCENE_SCALE, 1.0, &grid->scale);
}

static void visit_timelines(struct scene_density *density, timeline_visitor *visit, void *user)
{
    visit("center", &density->grid.center, user);
    visit("scale", &density->grid.scale, user);
    visit("unit_distance", &density->grid.unit_distance, user);
}

static void write_hash_text(const struct scene_density *density, FILE *text)
{
    const struct scene_grid *grid = &density->grid;
    const struct scene_raw *raw = &grid->raw;

    hash_text_string(text, "file", grid->file);
    hash_text_string(text, "grid", grid->grid_name);
    fprintf(text, " size %d %d %d type %d %d big %d skip %" PRId64 " nearest %d center %d points %zu", raw->size[0],
            raw->size[1], raw->size[2], raw->has_type, (int)raw->type, raw->is_big_endian, raw->skip_bytes,
            grid->is_nearest, grid->has_center, grid->point_count);
    hash_text_numbers(text, "spacing", grid->spacing, 3);
    for (size_t i = 0; i < grid->point_count; i++) {
        hash_text_numbers(text, "value", &grid->points[i].value, 1);
        hash_text_numbers(text, "rgba", grid->points[i].rgba, 4);
    }
}

static void finish(struct scene_density *density)
{
    free(density->grid.file);
    free(density->grid.grid_name);
    free(density->grid.points);
}

static bool is_sequence(const struct scene_density *density)
{
    return input_path_is_sequence(density->grid.file);
}

const struct density_rules density_rules_grid = {
    .name = "grid",
    .read = read,
    .visit = visit_timelines,
    .write_hash_text = write_hash_text,
    .finish = finish,
    .is_sequence = is_sequence,
};
