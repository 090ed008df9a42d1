// SPDX-License-Identifier: Apache-2.0
#include "worker/density/affine.h"
#include "worker/density/grid_lookup.h"
#include "worker/glsl/texture_units.h"
#include "worker/glsl/timeline_value.h"
#include "worker/scene/scene_inputs.h"
#include "worker/sparse/brick_atlas.h"
#include "worker/sparse/brick_store.h"
#include "worker/sparse/sparse_grid.h"
#include "worker/sparse/transfer_function.h"

#include <assert.h>
#include <math.h>

static const struct scene_input *input_of(const struct density_site *site)
{
    assert(site->inputs && site->inputs->media[site->medium].bricks);
    return &site->inputs->media[site->medium];
}

static void evaluate_shift(const void *source, double time, double value[static 9])
{
    const struct scene_input *input = source;
    double matrix[12], inverse[9];

    scene_input_find_matrix(source, time, matrix);
    affine_invert(matrix, inverse, value);
    for (int axis = 0; axis < 3; ++axis)
        value[axis] -= SPARSE_BRICK_SIDE * input->bricks->atlas->brick_min[axis];
}

static void evaluate_low(const void *source, double time, double value[static 9])
{
    const struct brick_atlas *atlas = ((const struct scene_input *)source)->bricks->atlas;

    for (int axis = 0; axis < 3; ++axis)
        value[axis] = atlas->voxel_min[axis] - 1 - SPARSE_BRICK_SIDE * atlas->brick_min[axis];
}

static void evaluate_high(const void *source, double time, double value[static 9])
{
    const struct brick_atlas *atlas = ((const struct scene_input *)source)->bricks->atlas;

    for (int axis = 0; axis < 3; ++axis)
        value[axis] = atlas->voxel_max[axis] + 1 - SPARSE_BRICK_SIDE * atlas->brick_min[axis];
}

static void add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    static const struct {
        const char *name;
        enum frame_value_type type;
        frame_value_evaluate *evaluate;
    } values[] = {{"to_lattice", FRAME_VALUE_MAT3, grid_lookup_evaluate_to_voxels},
                  {"shift", FRAME_VALUE_VEC3, evaluate_shift},
                  {"low", FRAME_VALUE_VEC3, evaluate_low},
                  {"high", FRAME_VALUE_VEC3, evaluate_high}};
    const struct scene_input *input = input_of(site);
    const struct scene_blackbody *blackbody = &site->source->blackbody;
    bool is_still = grid_lookup_is_still(input->source);

    for (size_t i = 0; i < sizeof values / sizeof *values; ++i)
        frame_uniforms_add(uniforms,
                           (struct frame_value){.type = values[i].type,
                                                .is_constant = !input->is_sequence && is_still,
                                                .evaluate = values[i].evaluate,
                                                .evaluate_linear = values[i].evaluate == evaluate_shift
                                                                       ? grid_lookup_evaluate_to_voxels
                                                                       : NULL,
                                                .source = input,
                                                .min = value_range_any.min,
                                                .max = value_range_any.max,
                                                .meaning = "density.file"},
                           "medium_%zu_%s", site->medium, values[i].name);
    grid_lookup_add_values(uniforms, site);
    if (!blackbody->grid_name) return;
    frame_uniforms_add(uniforms,
                       timeline_value(&blackbody->kelvin, FRAME_VALUE_FLOAT, value_range_any, "blackbody.kelvin"),
                       "medium_%zu_kelvin", site->medium);
    frame_uniforms_add(
        uniforms,
        timeline_value(&blackbody->intensity, FRAME_VALUE_FLOAT, value_range_not_negative, "blackbody.intensity"),
        "medium_%zu_intensity", site->medium);
}

static void evaluate_majorant(const void *source, double time, double value[static 9])
{
    const struct scene_input *input = source;
    const struct scene_grid *grid = input->source;
    const struct grid_bound bound = input->bricks->atlas->bound;

    if (grid->point_count == 0) {
        timeline_value_evaluate(&grid->scale, time, value);
        value[0] *= fmax((double)bound.max, 0);
        return;
    }
    timeline_value_evaluate(&grid->unit_distance, time, value);
    value[0] =
        -log1p(-transfer_function_max_opacity(grid->points, grid->point_count, (double)bound.min, (double)bound.max)) /
        value[0];
}

static void add_majorant(struct frame_uniforms *uniforms, const struct density_site *site)
{
    const struct scene_input *input = input_of(site);
    const struct scene_grid *grid = input->source;

    frame_uniforms_add(
        uniforms,
        (struct frame_value){.type = FRAME_VALUE_FLOAT,
                             .is_constant = !input->is_sequence &&
                                            (grid->point_count == 0 ? timeline_is_constant(&grid->scale)
                                                                    : timeline_is_constant(&grid->unit_distance)),
                             .evaluate = evaluate_majorant,
                             .source = input,
                             .min = value_range_not_negative.min,
                             .max = value_range_not_negative.max,
                             .meaning = "density.file"},
        "medium_%zu_majorant", site->medium);
}

static const char *const *modules(const struct density_site *site)
{
    enum { NOTHING, GLOW, TRANSFER }; // never both
    static const char *const names[2][3][4] = {
        {{"density/bricks.glsl", "density/bricks_linear.glsl", NULL},
         {"density/bricks.glsl", "density/bricks_linear.glsl", "emission/blackbody.glsl", NULL},
         {"density/bricks.glsl", "density/bricks_linear.glsl", "transfer/piecewise.glsl", NULL}},
        {{"density/bricks.glsl", "density/bricks_nearest.glsl", NULL},
         {"density/bricks.glsl", "density/bricks_nearest.glsl", "emission/blackbody.glsl", NULL},
         {"density/bricks.glsl", "density/bricks_nearest.glsl", "transfer/piecewise.glsl", NULL}}};
    const struct scene_grid *grid = &site->source->density.grid;

    return names[grid->is_nearest][grid->point_count > 0               ? TRANSFER
                                   : site->source->blackbody.grid_name ? GLOW
                                                                       : NOTHING];
}

static void write_glow(FILE *out, const char *filter, size_t i)
{
    fprintf(out,
            "layout(binding = %u) uniform sampler2DArray medium_%zu_heat;\n"
            "layout(binding = %u) uniform sampler2D medium_%zu_blackbody;\n",
            texture_unit_of_medium(i, MEDIUM_TEXTURE_EXTRA), i, texture_unit_of_medium(i, MEDIUM_TEXTURE_BLACKBODY), i);
    fprintf(out,
            "vec3 medium_%zu_glow(vec3 p)\n{\n"
            "    vec3 at = density_bricks_at(medium_%zu_bricks(), p);\n"
            "    uvec4 brick = density_bricks_find(medium_%zu_index, at);\n"
            "    if (brick.w > 0u) return vec3(0.0);\n"
            "    float kelvin = medium_%zu_kelvin * density_bricks_%s(medium_%zu_heat, brick, at);\n"
            "    return medium_%zu_intensity * emission_blackbody(medium_%zu_blackbody, kelvin);\n}\n",
            i, i, i, i, filter, i, i, i);
}

static void write(FILE *out, const struct density_site *site)
{
    const char *filter = site->source->density.grid.is_nearest ? "nearest" : "linear";
    bool is_transfer = site->source->density.grid.point_count > 0;
    size_t i = site->medium;

    fprintf(out,
            "layout(binding = %u) uniform sampler2DArray medium_%zu_atlas;\n"
            "layout(binding = %u) uniform usampler3D medium_%zu_index;\n"
            "DensityBricks medium_%zu_bricks()\n{\n    return DensityBricks(medium_%zu_to_lattice, medium_%zu_shift, "
            "medium_%zu_low, medium_%zu_high);\n}\n",
            texture_unit_of_medium(i, MEDIUM_TEXTURE_VALUES), i, texture_unit_of_medium(i, MEDIUM_TEXTURE_BRICKS), i, i,
            i, i, i, i);
    fprintf(out,
            "vec2 medium_%zu_support(vec3 origin, vec3 direction)\n{\n"
            "    return density_bricks_span(medium_%zu_bricks(), origin, direction);\n}\n",
            i, i);
    if (is_transfer) grid_lookup_write_transfer(out, &site->source->density.grid, i);
    fprintf(out,
            "// %s, how far ahead the grid is empty, and the value.\n"
            "vec3 medium_%zu_field(vec3 p, vec3 direction)\n{\n"
            "    DensityBricks grid = medium_%zu_bricks();\n"
            "    vec3 at = density_bricks_at(grid, p);\n"
            "    uvec4 brick = density_bricks_find(medium_%zu_index, at);\n"
            "    if (brick.w > 0u) return vec3(0.0, density_bricks_skip(grid, brick, at, direction), 0.0);\n"
            "    float value = density_bricks_%s(medium_%zu_atlas, brick, at);\n",
            is_transfer ? "Opacity" : "The value above 0", i, i, i, filter, i);
    if (is_transfer)
        fprintf(out, "    return vec3(medium_%zu_opacity(value), 0.0, value);\n}\n", i);
    else
        fprintf(out,
                "    return vec3(max(value, 0.0), 0.0, value);\n}\n"
                "float medium_%zu_density(vec3 field)\n{\n    return medium_%zu_scale * field.x;\n}\n",
                i, i);
    fprintf(out, "float medium_%zu_distance(vec3 field)\n{\n    return field.x > 0.0 ? -1.0 : field.y;\n}\n", i);
    if (site->source->blackbody.grid_name) write_glow(out, filter, i);
}

const struct density_kind density_kind_bricks = {
    .name = "grid",
    .field_type = "vec3",
    .has_support = true,
    .takes_direction = true,
    .is_zero = grid_lookup_is_zero,
    .has_color = grid_lookup_has_color,
    .add_values = add_values,
    .modules = modules,
    .write = write,
    .add_majorant = add_majorant,
};
