// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/light_grid_glue.h"

#include "core/job/job.h"
#include "worker/density/density_modules.h"
#include "worker/glsl/scene_cache.h"
#include "worker/glsl/texture_units.h"
#include "worker/model/light_grid.h"
#include "worker/model/light_kind.h"
#include "worker/model/scene_model.h"
#include "worker/model/scene_values.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scene_glue_media.h"

// The light's number in a program that marches, so that lights of a kind share one.
enum { MARCHED_LIGHT = 0 };

static const char channels[] = "xyzw";

const char *light_grid_glue_module(const struct light_grid *grid)
{
    return grid->kind == LIGHT_GRID_BEAM ? "light_grid/beam.glsl" : "light_grid/round.glsl";
}

// Writes the expression of the struct of a grid, whose light is `i` in the text.
static void write_grid(FILE *out, const struct light_grid *grid, size_t i)
{
    if (grid->kind == LIGHT_GRID_BEAM)
        fprintf(out,
                "LightGridBeam(light_%zu_grid_center, light_%zu_grid_from_unit, light_%zu_grid_to_unit, "
                "light_%zu_grid_origin, light_%zu_grid_taper)",
                i, i, i, i, i);
    else
        fprintf(out, "LightGridRound(light_%zu_position, light_%zu_grid_near, light_%zu_grid_far)", i, i, i);
}

void light_grid_glue_write_lookup(FILE *out, const struct light_grid *grid)
{
    size_t i = grid->light;

    fprintf(out, "layout(binding = %u) uniform sampler3D light_%zu_columns;\n", texture_unit_of_light(grid->light), i);
    fprintf(out, "MediaColumn light_%zu_column(vec3 point, LightSample light)\n{\n    vec3 at = light_grid_", i);
    fputs(grid->kind == LIGHT_GRID_BEAM ? "beam_at(" : "round_at(", out);
    write_grid(out, grid, i);
    fputs(grid->kind == LIGHT_GRID_BEAM ? ", point);\n" : ", light.direction, light.distance);\n", out);
    fprintf(out,
            "    vec4 marched = transmittance_cached(light_%zu_columns, at);\n"
            "    MediaColumn column = media_column_begin(media_spans(point, light.direction), light.distance);\n",
            i);
    for (size_t k = 0; k < grid->medium_count; ++k)
        fprintf(out, "    column.medium_%zu = marched.%c;\n", grid->media[k], channels[k]);
    fputs("    return column;\n}\n", out);
}

// Returns the model of the media whose columns the grid holds.
static struct scene_model marched_part(const struct light_grid *grid, const struct scene_model *picture)
{
    struct scene_model model = {.job = picture->job,
                                .inputs = picture->inputs,
                                .features = {.medium_count = picture->features.medium_count,
                                             .has_media = true,
                                             .has_extinction = true,
                                             .marches_to_lights = true}};

    for (size_t k = 0; k < grid->medium_count; ++k) {
        size_t i = grid->media[k];

        model.features.media[i] = picture->features.media[i];
        model.features.takes_time |= density_kind_of(&model.job->scene.media[i].density)->takes_time;
    }
    return model;
}

static void write_store(FILE *out, const struct light_grid *grid)
{
    fputs("void light_grid_store(ivec3 at, MediaColumn column)\n{\n    imageStore(cache_image, at, vec4(", out);
    for (size_t k = 0; k < JOB_CACHED_MEDIUM_LIMIT; ++k) {
        fputs(k > 0 ? ", " : "", out);
        if (k < grid->medium_count)
            fprintf(out, "column.medium_%zu", grid->media[k]);
        else
            fputs("0.0", out);
    }
    fprintf(out, "));\n}\nvoid light_grid_cut(inout MediaColumn column)\n{\n    column.medium_%zu = -1e6;\n}\n",
            grid->media[0]);
}

static void write_main(FILE *out, const struct light_grid *grid, const struct scene_cache *cache)
{
    fputs("void main()\n{\n", out);
    if (cache->uniforms.size_bytes > 0) fputs("    frame_uniforms_read();\n", out);
    fputs("    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n"
          "    int cells = imageSize(cache_image).z - 1;\n"
          "    LightGridRay ray = light_grid_",
          out);
    fputs(grid->kind == LIGHT_GRID_BEAM ? "beam_ray(" : "round_ray(", out);
    write_grid(out, grid, MARCHED_LIGHT);
    fputs(", vec2(at.xy) / float(cells));\n    light_grid_march(ray, at.xy, cells);\n}\n", out);
}

static bool assemble(struct scene_cache *cache, const struct light_grid *grid, const struct scene_model *marched,
                     const char *shader_dir, struct error *error)
{
    struct shader_assembly text;

    if (!scene_cache_begin(cache, &text, shader_dir, error)) return false;
    shader_assembly_add(&text, "math/constants.glsl");
    shader_assembly_generate(&text);
    frame_uniforms_declare(&cache->uniforms, text.out);
    shader_assembly_add(&text, "math/march.glsl");
    shader_assembly_add(&text, "region/span.glsl");
    for (size_t k = 0; k < grid->medium_count; ++k) {
        const struct density_site site = scene_model_site(marched, grid->media[k]);

        density_modules_add(&text, &site);
    }
    shader_assembly_generate(&text);
    scene_glue_write_columns(text.out, marched);
    write_store(text.out, grid);
    shader_assembly_add(&text, "light_grid/ray.glsl");
    shader_assembly_add(&text, light_grid_glue_module(grid));
    shader_assembly_add(&text, "light_grid/march.glsl");
    shader_assembly_generate(&text);
    write_main(text.out, grid, cache);
    return scene_cache_end(cache, &text);
}

// Returns what both caches have in common. The second takes the texture unit over once it is there.
static struct scene_cache cache_of(const struct light_grid *grid)
{
    int nodes = grid->cells + 1;

    return (struct scene_cache){.unit = texture_unit_of_light(grid->light),
                                .format = grid->medium_count == 1   ? SCENE_CACHE_R32F
                                          : grid->medium_count == 2 ? SCENE_CACHE_RG32F
                                                                    : SCENE_CACHE_RGBA32F,
                                .size = {nodes, nodes, nodes},
                                .invocations = {nodes, nodes, 1}};
}

static bool make_columns(struct scene_cache *cache, const struct light_grid *grid, const struct scene_model *model,
                         const char *shader_dir, struct error *error)
{
    const struct scene_model marched = marched_part(grid, model);

    *cache = cache_of(grid);
    cache->is_step = true;
    snprintf(cache->name, sizeof cache->name, "light_%zu_marched", grid->light);
    for (size_t k = 0; k < grid->medium_count; ++k)
        cache->reads_files |= marched.inputs && marched.inputs->media[grid->media[k]].source;
    scene_values_add_densities(&cache->uniforms, &marched);
    cache->uniforms.is_shared = true;
    if (grid->kind == LIGHT_GRID_ROUND)
        light_kind_add_position(&cache->uniforms, &grid->job->scene.lights[grid->light], MARCHED_LIGHT);
    light_grid_add_values(&cache->uniforms, grid, MARCHED_LIGHT);
    return assemble(cache, grid, &marched, shader_dir, error);
}

static bool make_kept(struct scene_cache *cache, const struct light_grid *grid, const char *shader_dir,
                      struct error *error)
{
    struct shader_assembly text;

    *cache = cache_of(grid);
    cache->invocations[2] = cache->size[2];
    snprintf(cache->name, sizeof cache->name, "light_%zu_columns", grid->light);
    if (!scene_cache_begin(cache, &text, shader_dir, error)) return false;
    shader_assembly_add(&text, "light_grid/keep.glsl");
    shader_assembly_generate(&text);
    fprintf(text.out,
            "layout(binding = %u) uniform sampler3D columns;\nvoid main()\n{\n"
            "    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n"
            "    imageStore(cache_image, at, light_grid_keep(columns, at));\n}\n",
            cache->unit);
    return scene_cache_end(cache, &text);
}

bool light_grid_glue_add_caches(struct scene_cache *caches, size_t *count, const struct light_grid *grid,
                                const struct scene_model *model, const char *shader_dir, struct error *error)
{
    if (!make_columns(&caches[*count], grid, model, shader_dir, error)) return false;
    caches[*count].reads = grid->densities;
    *count += 1;
    if (!make_kept(&caches[*count], grid, shader_dir, error)) return false;
    caches[*count].reads = (uint64_t)1 << (*count - 1);
    *count += 1;
    return true;
}
