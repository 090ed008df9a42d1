// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scatter_grid_glue.h"

#include "core/job/job.h"
#include "worker/glsl/scene_cache.h"
#include "worker/glsl/texture_units.h"
#include "worker/model/light_grid.h"
#include "worker/model/light_kind.h"
#include "worker/model/scatter_grid.h"
#include "worker/model/scene_model.h"
#include "worker/model/scene_values.h"
#include "worker/shader/integrators.h"
#include "worker/shader/light_grid_glue.h"
#include "worker/shader/scatter_media_glue.h"
#include "worker/shader/scatter_seen_glue.h"
#include "worker/shader/scatter_send_glue.h"
#include "worker/shader/scatter_walk_glue.h"
#include "worker/shader/scene_glue.h"
#include "worker/shader/scene_glue_tracking.h"
#include "worker/shader/scene_modules.h"

void scatter_grid_glue_write_lookup(FILE *out, const struct scatter_grid *grid, const struct scene_model *model)
{
    fprintf(out, "layout(binding = %d) uniform sampler3D scatter_grid_values;\n", TEXTURE_UNIT_SCATTER);
    for (size_t k = 0; k < grid->medium_count; ++k) {
        size_t i = grid->media[k];

        fprintf(out,
                "Spectrum medium_%zu_scattered(vec3 point)\n{\n"
                "    vec3 at = (point - scatter_grid_low) / scatter_grid_size;\n"
                "    return scatter_grid_look(scatter_grid_values, at, %zu, %zu).%s;\n}\n",
                i, grid->groups[i], grid->group_count, model->features.is_rgb ? "rgb" : "r");
    }
}

static void write_main_from_lights(FILE *out, const struct scatter_grid *grid, const struct scene_cache *cache)
{
    fputs("void main()\n{\n", out);
    if (cache->uniforms.size_bytes > 0) fputs("    frame_uniforms_read();\n", out);
    fprintf(out, "    ivec3 at;\n    if (cache_find_invocation(at)) scatter_grid_send(at, %d);\n}\n",
            grid->job->scene.orders);
}

static void write_main(FILE *out, const struct scatter_grid *grid, const struct scene_cache *cache)
{
    fputs("void main()\n{\n", out);
    if (cache->uniforms.size_bytes > 0) fputs("    frame_uniforms_read();\n", out);
    // A light's order counts up to that; a float holds it exactly.
    fprintf(out, "    scatter_grid_fill(%d);\n}\n", grid->job->scene.orders);
}

static void add_lights(struct shader_assembly *text, const struct scatter_grid_program *program)
{
    const struct scene_model *walked = program->walked;

    scene_modules_add_lights(text, walked);
    scene_modules_add_draws(text, walked);
    if (!walked->features.media_are_lit || program->grid->is_from_lights) {
        shader_assembly_generate(text);
        scene_glue_write_lights(text->out, walked);
        return;
    }
    if (walked->features.has_light_grids) {
        shader_assembly_add(text, "transmittance/cached.glsl");
        shader_assembly_add(text, "light_grid/ray.glsl");
    } else if (!walked->features.marches_to_lights) {
        shader_assembly_add(text, "transmittance/closed.glsl");
    } else {
        shader_assembly_add(text, integrator_to_lights(walked)->module);
    }
    for (size_t i = 0; i < program->light_grid_count; ++i)
        shader_assembly_add(text, light_grid_glue_module(&program->light_grids[i]));
    shader_assembly_generate(text);
    scene_glue_write_lights(text->out, walked);
    if (walked->features.estimates_columns) scene_glue_write_estimate(text->out, walked);
    for (size_t i = 0; i < program->light_grid_count; ++i)
        light_grid_glue_write_lookup(text->out, &program->light_grids[i]);
}

static int channel_count(const struct scatter_grid *grid)
{
    return grid->is_rgb ? 3 : 1;
}

static void write_lanes(FILE *out, const struct scatter_grid *grid)
{
    fprintf(out, "const int SCATTER_GRID_LANES = %d;\n", scatter_grid_lane_count(grid));
}

static void add_walks(struct shader_assembly *text, const struct scatter_grid_program *program,
                      const struct scene_cache *cache)
{
    struct scatter_walk_text walks = {.model = program->walked, .grid = program->grid};

    if (scatter_grid_is_similar(program->grid) && scatter_walk_glue_is_forward(program->walked, program->grid))
        shader_assembly_add(text, "scatter_grid/similar.glsl");
    if (scatter_walk_glue_is_sharp(program->walked, program->grid)) {
        shader_assembly_generate(text);
        walks.lamp_count = scatter_walk_glue_write_lamps(text->out, program->walked);
        if (walks.lamp_count > 0) shader_assembly_add(text, "scatter_grid/aim.glsl");
    }
    shader_assembly_generate(text);
    walks.out = text->out;
    scatter_walk_glue_write(&walks);
    fprintf(text->out, "layout(binding = %d) uniform sampler3D scatter_seen;\n", TEXTURE_UNIT_SCATTER_SEEN);
    write_lanes(text->out, program->grid);
    fprintf(text->out, "const int SCATTER_GRID_SETS = %zu;\n", program->grid->group_count);
    fprintf(text->out, "const int CACHE_STEPS = %d; // that count as one\n", SCENE_CACHE_STEPS);
    shader_assembly_add(text, "scatter_grid/walk.glsl");
    shader_assembly_generate(text);
    write_main(text->out, program->grid, cache);
}

static void write_channels(FILE *out, const struct scatter_grid *grid)
{
    fprintf(out, "const int SCATTER_GRID_CHANNELS = %d;\n", channel_count(grid));
}

static void add_particles(struct shader_assembly *text, const struct scatter_grid_program *program,
                          const struct scene_cache *cache)
{
    shader_assembly_add(text, "scatter_grid/sources.glsl");
    shader_assembly_generate(text);
    scatter_walk_glue_write_scatter(&(struct scatter_walk_text){text->out, program->walked, program->grid, 0});
    scatter_send_glue_write(text->out, program->walked, program->grid);
    write_channels(text->out, program->grid);
    shader_assembly_add(text, "scatter_grid/send.glsl");
    shader_assembly_generate(text);
    write_main_from_lights(text->out, program->grid, cache);
}

// What was aimed at a lamp is faint, and meets light that is not.
static void write_faint(FILE *out, const struct scatter_grid_program *program)
{
    bool aims = !program->grid->is_from_lights && scatter_walk_glue_is_sharp(program->walked, program->grid);

    fprintf(out, "const float SCATTER_GRID_FAINT = %s; // what carries less ends at random\n", aims ? "0.02" : "0.25");
}

static bool assemble(struct scene_cache *cache, const struct scatter_grid_program *program, const char *shader_dir,
                     struct error *error)
{
    struct shader_assembly text;

    if (!scene_cache_begin(cache, &text, shader_dir, error)) return false;
    scatter_media_glue_add(&text, program, cache);
    add_lights(&text, program);
    shader_assembly_generate(&text);
    write_faint(text.out, program);
    shader_assembly_add(&text, "scatter_grid/turns.glsl");
    if (program->grid->is_from_lights)
        add_particles(&text, program, cache);
    else
        add_walks(&text, program, cache);
    return scene_cache_end(cache, &text);
}

// Returns what both caches have in common. The second takes the texture unit over once it is there.
static struct scene_cache cache_of(const struct scatter_grid *grid)
{
    int layers = grid->nodes[2] * (int)grid->group_count;

    return (struct scene_cache){.unit = TEXTURE_UNIT_SCATTER,
                                .format = SCENE_CACHE_RGBA32F,
                                .size = {grid->nodes[0], grid->nodes[1], layers},
                                .invocations = {grid->nodes[0], grid->nodes[1], layers}};
}

// Walks from the nodes: each lane of a node is a part.
static void lay_walks(struct scene_cache *cache, const struct scatter_grid *grid)
{
    static const int GROUPS_MOST = 4096; // at once

    cache->size[0] *= scatter_grid_lane_count(grid);
    cache->invocations[0] = SCENE_CACHE_GROUP_SIDE;
    cache->invocations[1] = GROUPS_MOST * SCENE_CACHE_GROUP_SIDE;
    cache->invocations[2] = 1;
    cache->part_count = (size_t)cache->size[0] * (size_t)cache->size[1] * (size_t)cache->size[2];
    cache->reads_sums = cache->counts_walks = true;
    cache->sum_count = SCATTER_SEEN_SUMS;
}

// Particles: an invocation keeps four texels, and all add to the sums.
static void lay_particles(struct scene_cache *cache, const struct scatter_grid *grid)
{
    cache->size[0] = cache->invocations[0] = SCATTER_GRID_ROW;
    cache->size[1] = cache->invocations[1] = scatter_grid_row_count(grid);
    cache->size[2] = 4;
    cache->invocations[2] = 1;
    cache->sum_count = 2 + 2 * (size_t)channel_count(grid) * grid->group_count * scatter_grid_node_count(grid);
}

static bool make_means(struct scene_cache *cache, const struct scatter_grid_program *program, const char *shader_dir,
                       struct error *error)
{
    const struct scatter_grid *grid = program->grid;
    const struct scene_model *walked = program->walked;

    *cache = cache_of(grid);
    if (grid->is_from_lights)
        lay_particles(cache, grid);
    else
        lay_walks(cache, grid);
    cache->takes_turns = cache->is_step = true;
    cache->reads = program->reads;
    snprintf(cache->name, sizeof cache->name, "scatter_means");
    cache->reads_files = scatter_media_glue_reads_files(program);
    scene_values_add(&cache->uniforms, walked);
    scatter_grid_add_values(&cache->uniforms, grid);
    if (grid->is_from_lights)
        scatter_grid_add_sent(&cache->uniforms, grid);
    else
        scatter_grid_add_paths(&cache->uniforms, grid);
    for (size_t i = 0; i < program->light_grid_count; ++i)
        light_grid_add_values(&cache->uniforms, &program->light_grids[i], program->light_grids[i].light);
    return assemble(cache, program, shader_dir, error);
}

static void add_keep_sums(struct shader_assembly *text, const struct scene_cache *cache,
                          const struct scatter_grid *grid)
{
    shader_assembly_add(text, "math/constants.glsl");
    shader_assembly_generate(text);
    frame_uniforms_declare(&cache->uniforms, text->out);
    write_channels(text->out, grid);
    shader_assembly_add(text, "scatter_grid/keep_sums.glsl");
    shader_assembly_generate(text);
    fprintf(text->out,
            "layout(binding = %u) uniform sampler3D states;\nvoid main()\n{\n%s"
            "    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n"
            "    float sent = scatter_grid_sent * float(textureSize(states, 0).x * textureSize(states, 0).y);\n"
            "    vec3 cell = scatter_grid_size / (scatter_grid_nodes - 1.0);\n"
            "    imageStore(cache_image, at, scatter_grid_keep(states, at, imageSize(cache_image), %zu, cell, sent));\n"
            "}\n",
            cache->unit, cache->uniforms.size_bytes > 0 ? "    frame_uniforms_read();\n" : "", grid->group_count);
}

static bool make_kept(struct scene_cache *cache, const struct scatter_grid *grid, const char *shader_dir,
                      struct error *error)
{
    struct shader_assembly text;

    *cache = cache_of(grid);
    cache->reads_sums = grid->is_from_lights;
    snprintf(cache->name, sizeof cache->name, "scatter_grid");
    if (grid->is_from_lights) {
        scatter_grid_add_values(&cache->uniforms, grid);
        scatter_grid_add_sent(&cache->uniforms, grid);
    }
    if (!scene_cache_begin(cache, &text, shader_dir, error)) return false;
    if (grid->is_from_lights) {
        add_keep_sums(&text, cache, grid);
        return scene_cache_end(cache, &text);
    }
    write_lanes(text.out, grid);
    shader_assembly_add(&text, "scatter_grid/keep.glsl");
    shader_assembly_generate(&text);
    fprintf(text.out,
            "layout(binding = %u) uniform sampler3D means;\nvoid main()\n{\n"
            "    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n"
            "    imageStore(cache_image, at, scatter_grid_keep(means, at, %zu));\n}\n",
            cache->unit, grid->group_count);
    return scene_cache_end(cache, &text);
}

bool scatter_grid_glue_add_caches(struct scene_cache *caches, size_t *count, const struct scatter_grid_program *program,
                                  const char *shader_dir, struct error *error)
{
    struct scatter_grid_program filled = *program;

    if (!program->grid->is_from_lights) {
        if (!scatter_seen_glue_make(&caches[*count], program, shader_dir, error)) return false;
        filled.reads |= (uint64_t)1 << *count;
        *count += 1;
    }
    if (!make_means(&caches[*count], &filled, shader_dir, error)) return false;
    *count += 1;
    if (!make_kept(&caches[*count], program->grid, shader_dir, error)) return false;
    caches[*count].reads = (uint64_t)1 << (*count - 1);
    *count += 1;
    return true;
}
