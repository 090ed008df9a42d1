// SPDX-License-Identifier: Apache-2.0
#include "worker/density/grid_lookup.h"

#include "worker/density/affine.h"
#include "worker/density/transfer_table.h"
#include "worker/glsl/texture_units.h"
#include "worker/glsl/timeline_value.h"
#include "worker/scene/scene_inputs.h"
#include "worker/sparse/transfer_function.h"

#include <math.h>

bool grid_lookup_is_zero(const struct scene_density *density)
{
    const struct scene_grid *grid = &density->grid;

    if (grid->point_count == 0) return timeline_value_is_zero(&grid->scale);
    return transfer_function_max_opacity(grid->points, grid->point_count, -INFINITY, INFINITY) <= 0;
}

bool grid_lookup_has_color(const struct scene_density *density)
{
    return density->grid.point_count > 0;
}

const char *grid_lookup_sampler_prefix(enum volume_type type)
{
    switch (type) {
    case VOLUME_UINT8:
    case VOLUME_UINT16:
        return "u";
    case VOLUME_INT16:
        return "i";
    case VOLUME_FLOAT32:
        break;
    }
    return "";
}

void grid_lookup_evaluate_to_voxels(const void *source, double time, double value[static 9])
{
    double matrix[12], shift[3];

    scene_input_find_matrix(source, time, matrix);
    affine_invert(matrix, value, shift);
}

bool grid_lookup_is_still(const struct scene_grid *grid)
{
    return !grid->has_center || timeline_is_constant(&grid->center);
}

void grid_lookup_add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    const struct scene_grid *grid = &site->source->density.grid;

    if (grid->point_count > 0)
        frame_uniforms_add(
            uniforms,
            timeline_value(&grid->unit_distance, FRAME_VALUE_FLOAT, value_range_positive, "density.unit_distance"),
            "medium_%zu_unit_distance", site->medium);
    else
        frame_uniforms_add(uniforms,
                           timeline_value(&grid->scale, FRAME_VALUE_FLOAT, value_range_not_negative, "density.scale"),
                           "medium_%zu_scale", site->medium);
}

void grid_lookup_write_transfer(FILE *out, const struct scene_grid *grid, size_t i)
{
    char prefix[32];

    snprintf(prefix, sizeof prefix, "medium_%zu", i);
    transfer_function_write(out, prefix, grid->points, grid->point_count);
    fprintf(out,
            "float medium_%zu_density(vec3 field)\n{\n"
            "    return transfer_extinction(field.x, medium_%zu_unit_distance);\n}\n"
            "vec3 medium_%zu_color(vec3 field)\n{\n    return medium_%zu_rgb(field.z);\n}\n",
            i, i, i, i);
}

void grid_lookup_write_table(FILE *out, const struct scene_grid *grid, size_t i)
{
    double first = grid->points[0].value, last = grid->points[grid->point_count - 1].value;

    fprintf(
        out,
        "layout(binding = %u) uniform sampler2D medium_%zu_table;\n"
        "float medium_%zu_position(float value)\n{\n    return (value - %.9e) * %.9e + 1.0;\n}\n"
        "TransferEnd medium_%zu_end_at(float position)\n{\n    return transfer_end(medium_%zu_table, position);\n}\n",
        texture_unit_of_medium(i, MEDIUM_TEXTURE_EXTRA), i, i, first, TRANSFER_TABLE_CELLS / (last - first), i, i);
    fprintf(out,
            "float medium_%zu_density(vec4 mean)\n{\n    return mean.a / medium_%zu_unit_distance;\n}\n"
            "vec3 medium_%zu_color(vec4 mean)\n{\n    return mean.rgb / max(mean.a, 1e-30);\n}\n",
            i, i, i);
}
