// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "worker/density/affine.h"
#include "worker/density/grid_lookup.h"
#include "worker/glsl/texture_units.h"
#include "worker/glsl/timeline_value.h"
#include "worker/scene/scene_inputs.h"

#include <assert.h>

static const struct scene_input *input_of(const struct density_site *site)
{
    assert(site->inputs && site->inputs->media[site->medium].source);
    return &site->inputs->media[site->medium];
}

static void evaluate_shift(const void *source, double time, double value[static 9])
{
    double matrix[12], inverse[9];

    scene_input_find_matrix(source, time, matrix);
    affine_invert(matrix, inverse, value);
}

static void evaluate_size(const void *source, double time, double value[static 9])
{
    const struct scene_input *input = source;

    for (int axis = 0; axis < 3; ++axis)
        value[axis] = input->header.size[axis];
}

static void evaluate_slope(const void *source, double time, double value[static 9])
{
    const struct scene_input *input = source;

    value[0] = input->header.slope;
}

static void evaluate_intercept(const void *source, double time, double value[static 9])
{
    const struct scene_input *input = source;

    value[0] = input->header.intercept;
}

static void add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    static const struct {
        const char *name;
        enum frame_value_type type;
        bool is_shift; // depends on the grid's centre
        frame_value_evaluate *evaluate;
    } values[] = {{"to_index", FRAME_VALUE_MAT3, false, grid_lookup_evaluate_to_voxels},
                  {"shift", FRAME_VALUE_VEC3, true, evaluate_shift},
                  {"size", FRAME_VALUE_VEC3, false, evaluate_size},
                  {"slope", FRAME_VALUE_FLOAT, false, evaluate_slope},
                  {"intercept", FRAME_VALUE_FLOAT, false, evaluate_intercept}};
    const struct scene_input *input = input_of(site);
    bool is_still = grid_lookup_is_still(input->source);
    size_t medium = site->medium;

    for (size_t i = 0; i < sizeof values / sizeof *values; ++i)
        frame_uniforms_add(
            uniforms,
            (struct frame_value){.type = values[i].type,
                                 .is_constant = !input->is_sequence && (is_still || !values[i].is_shift),
                                 .evaluate = values[i].evaluate,
                                 .evaluate_linear = values[i].is_shift ? grid_lookup_evaluate_to_voxels : NULL,
                                 .source = input,
                                 .min = value_range_any.min,
                                 .max = value_range_any.max,
                                 .meaning = "density.file"},
            "medium_%zu_%s", medium, values[i].name);
    grid_lookup_add_values(uniforms, site);
}

static bool has_table(const struct scene_density *density)
{
    return density->grid.point_count > 0 && !density->grid.is_nearest;
}

static bool is_tabled(const struct density_site *site)
{
    return site->job->quality.method == JOB_METHOD_PREINTEGRATED && has_table(&site->source->density);
}

static const char *const *modules(const struct density_site *site)
{
    static const char *const tabled[] = {"density/grid.glsl",        "density/grid_linear.glsl",
                                         "density/grid_bricks.glsl", "transfer/piecewise.glsl",
                                         "transfer/table.glsl",      NULL};
    static const char *const names[2][2][5] = {
        {{"density/grid.glsl", "density/grid_linear.glsl", "density/grid_bricks.glsl", NULL},
         {"density/grid.glsl", "density/grid_linear.glsl", "density/grid_bricks.glsl", "transfer/piecewise.glsl",
          NULL}},
        {{"density/grid.glsl", "density/grid_nearest.glsl", "density/grid_bricks.glsl", NULL},
         {"density/grid.glsl", "density/grid_nearest.glsl", "density/grid_bricks.glsl", "transfer/piecewise.glsl",
          NULL}}};
    const struct scene_grid *grid = &site->source->density.grid;

    return is_tabled(site) ? tabled : names[grid->is_nearest][grid->point_count > 0];
}

static void write_grid(FILE *out, const struct scene_input *input, size_t i)
{
    fprintf(out,
            "layout(binding = %u) uniform %ssampler2DArray medium_%zu_voxels;\n"
            "layout(binding = %u) uniform sampler3D medium_%zu_bricks;\n",
            texture_unit_of_medium(i, MEDIUM_TEXTURE_VALUES), grid_lookup_sampler_prefix(input->header.type), i,
            texture_unit_of_medium(i, MEDIUM_TEXTURE_BRICKS), i);
    fprintf(out,
            "DensityGrid medium_%zu_grid()\n{\n    return DensityGrid(medium_%zu_to_index, medium_%zu_shift, "
            "medium_%zu_size, medium_%zu_slope, medium_%zu_intercept);\n}\n",
            i, i, i, i, i, i);
    fprintf(out,
            "vec2 medium_%zu_support(vec3 origin, vec3 direction)\n{\n"
            "    return density_grid_span(medium_%zu_grid(), origin, direction);\n}\n",
            i, i);
    fprintf(
        out,
        "float medium_%zu_value(vec3 at)\n{\n    return density_grid_%s(medium_%zu_voxels, medium_%zu_grid(), at);\n}\n"
        "float medium_%zu_skip(vec3 at, vec3 direction)\n{\n"
        "    return density_grid_skip(medium_%zu_bricks, medium_%zu_grid(), at, direction);\n}\n",
        i, input->source->is_nearest ? "nearest" : "linear", i, i, i, i, i);
}

static void write_transfer(FILE *out, const struct scene_grid *grid, size_t i)
{
    grid_lookup_write_transfer(out, grid, i);
    fprintf(out,
            "// Opacity, how far ahead the grid is empty, and the value.\n"
            "vec3 medium_%zu_field(vec3 p, vec3 direction)\n{\n"
            "    vec3 at = density_grid_index(medium_%zu_grid(), p);\n    float value = medium_%zu_value(at);\n"
            "    return vec3(medium_%zu_opacity(value), medium_%zu_skip(at, direction), value);\n}\n",
            i, i, i, i, i);
}

// Beyond the outer voxel centres the value is that of the nearest one, as everywhere.
static void write_table(FILE *out, const struct scene_grid *grid, size_t i)
{
    grid_lookup_write_table(out, grid, i);
    fprintf(out,
            "TransferEnd medium_%zu_end(vec3 p)\n{\n"
            "    return medium_%zu_end_at(medium_%zu_position(medium_%zu_value(density_grid_index(medium_%zu_grid(), "
            "p))));\n}\n"
            "float medium_%zu_clear(vec3 p, vec3 direction)\n{\n"
            "    return medium_%zu_skip(density_grid_index(medium_%zu_grid(), p), direction);\n}\n",
            i, i, i, i, i, i, i, i);
}

static void write_scale(FILE *out, size_t i)
{
    fprintf(out,
            "// The value, and how far ahead the grid is empty.\n"
            "vec3 medium_%zu_field(vec3 p, vec3 direction)\n{\n"
            "    vec3 at = density_grid_index(medium_%zu_grid(), p);\n"
            "    return vec3(medium_%zu_value(at), medium_%zu_skip(at, direction), 0.0);\n}\n",
            i, i, i, i);
    fprintf(out, "float medium_%zu_density(vec3 field)\n{\n    return medium_%zu_scale * max(field.x, 0.0);\n}\n", i,
            i);
}

static void write(FILE *out, const struct density_site *site)
{
    const struct scene_grid *grid = &site->source->density.grid;

    write_grid(out, input_of(site), site->medium);
    if (grid->point_count > 0) write_transfer(out, grid, site->medium);
    if (is_tabled(site)) write_table(out, grid, site->medium);
    if (grid->point_count == 0) write_scale(out, site->medium);
    fprintf(out,
            "float medium_%zu_distance(vec3 field)\n{\n"
            "    return field.y > 0.0 ? field.y : field.x > 0.0 ? -1.0 : 0.0;\n}\n",
            site->medium);
}

// The majorant is by brick, whose largest values are known once the file was read.
static void write_most(FILE *out, const struct density_site *site)
{
    const struct scene_grid *grid = &site->source->density.grid;
    size_t i = site->medium;

    fprintf(out,
            "layout(binding = %u) uniform sampler3D medium_%zu_majorants;\n"
            "DensityGridRay medium_%zu_ray(vec3 origin, vec3 direction)\n{\n"
            "    return density_grid_ray(medium_%zu_grid(), origin, direction);\n}\n"
            "float medium_%zu_most(MediaRay ray, float at, inout float extent)\n{\n    float own;\n"
            "    float most = density_grid_majorant(medium_%zu_majorants, ray.medium_%zu, at, own);\n"
            "    extent = min(extent, own);\n",
            texture_unit_of_medium(i, MEDIUM_TEXTURE_EXTRA), i, i, i, i, i, i);
    if (grid->point_count > 0)
        fprintf(out, "    return transfer_extinction(max(most, 0.0), medium_%zu_unit_distance);\n}\n", i);
    else
        fprintf(out, "    return medium_%zu_scale * max(most, 0.0);\n}\n", i);
}

const struct density_kind density_kind_grid = {
    .name = "grid",
    .field_type = "vec3",
    .has_support = true,
    .takes_direction = true,
    .is_zero = grid_lookup_is_zero,
    .has_color = grid_lookup_has_color,
    .has_table = has_table,
    .add_values = add_values,
    .modules = modules,
    .write = write,
    .write_most = write_most,
    .ray_type = "DensityGridRay",
    .majorant_module = "density/grid_majorant.glsl",
};
