// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_program.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/density/density_bake.h"
#include "worker/density/density_fill.h"
#include "worker/density/density_modules.h"
#include "worker/glsl/shader_sources.h"
#include "worker/model/light_grid.h"
#include "worker/model/light_kind.h"
#include "worker/model/scatter_grid.h"
#include "worker/model/scene_values.h"
#include "worker/scene/camera_view.h"
#include "worker/shader/integrators.h"
#include "worker/shader/light_grid_glue.h"
#include "worker/shader/scatter_grid_glue.h"
#include "worker/shader/scatter_media_glue.h"
#include "worker/shader/scene_glue.h"
#include "worker/shader/scene_glue_gather.h"
#include "worker/shader/scene_glue_media.h"
#include "worker/shader/scene_glue_path.h"
#include "worker/shader/scene_glue_slice.h"
#include "worker/shader/scene_glue_steps.h"
#include "worker/shader/scene_glue_surface.h"
#include "worker/shader/scene_glue_tracking.h"
#include "worker/shader/scene_glue_walk.h"
#include "worker/shader/scene_glue_walk_aim.h"
#include "worker/shader/scene_glue_walk_aside.h"
#include "worker/shader/scene_glue_walk_lamps.h"
#include "worker/shader/scene_glue_walk_light.h"
#include "worker/shader/scene_modules.h"
#include "worker/shader/texture_glue.h"

#include <stdlib.h>
#include <string.h>

struct assembly {
    struct scene_program *program;
    const struct scene_model *model; // of the program
    struct shader_assembly text;     // of the fragment shader
};

static void add_module(struct assembly *assembly, const char *name)
{
    shader_assembly_add(&assembly->text, name);
}

// Returns where to write glue.
static FILE *generate(struct assembly *assembly)
{
    shader_assembly_generate(&assembly->text);
    return assembly->text.out;
}

static void add_camera(struct assembly *assembly)
{
    const struct scene_features *features = &assembly->model->features;

    if (features->marches || features->marches_to_lights || features->has_objects || features->is_walked)
        add_module(assembly, "math/march.glsl");
    add_module(assembly, "camera/pixel.glsl");
    add_module(assembly, "camera/pinhole.glsl");
    if (features->is_random) add_module(assembly, "math/random.glsl");
    if (features->has_samples) add_module(assembly, "camera/pixel_samples.glsl");
    add_module(assembly, "region/span.glsl");
}

static void add_tracking(struct assembly *assembly)
{
    const struct scene_features *features = &assembly->model->features;

    if (features->has_majorants) add_module(assembly, "math/tracking.glsl");
    scene_glue_write_tracking(generate(assembly), assembly->model);
    if (features->is_walked) return;
    if (features->estimates_columns) {
        if (!features->has_majorants) add_module(assembly, "math/segment.glsl");
        if (!features->has_majorants) add_module(assembly, "transmittance/comb.glsl");
        add_module(assembly, integrator_to_lights(assembly->model)->module);
    }
    if (features->has_lights || !features->has_majorants)
        scene_glue_write_estimate(generate(assembly), assembly->model);
}

static void add_media(struct assembly *assembly)
{
    const struct scene_features *features = &assembly->model->features;
    bool is_random = features->is_tracked || features->is_walked;

    for (size_t i = 0; i < features->medium_count; ++i)
        if (features->media[i].is_seen) scene_modules_add_density(&assembly->text, assembly->model, i);
    if (features->has_extinction && !is_random && assembly->model->job->quality.method != JOB_METHOD_RIEMANN)
        add_module(assembly, "math/segment.glsl");
    if (features->has_extinction && features->has_depth && !is_random)
        add_module(assembly, features->extinction_is_rgb ? "pass/depth_rgb.glsl" : "pass/depth_grey.glsl");
    scene_glue_write_media(generate(assembly), assembly->model);
    scene_glue_write_steps(assembly->text.out, assembly->model);
    if (is_random) add_tracking(assembly);
}

static void add_placement(struct assembly *assembly)
{
    const struct scene *scene = &assembly->model->job->scene;

    add_module(assembly, "placement/share.glsl");
    if (assembly->model->features.extinction_is_rgb) add_module(assembly, "placement/cut.glsl");
    for (size_t i = 0; i < scene->light_count; ++i) {
        bool is_by_angle = light_kind_of(&scene->lights[i])->is_inverse_square;

        if (!assembly->model->features.light_is_marched[i]) continue;
        if (is_by_angle) add_module(assembly, "math/arc.glsl");
        add_module(assembly, is_by_angle ? "placement/angle.glsl" : "placement/transmittance.glsl");
    }
    if (assembly->model->features.has_scatter_grid) add_module(assembly, "placement/transmittance.glsl");
    scene_glue_write_placed(generate(assembly), assembly->model->job);
}

static void add_light_grids(struct assembly *assembly)
{
    const struct scene_program *program = assembly->program;

    add_module(assembly, "light_grid/ray.glsl");
    for (size_t i = 0; i < program->light_grid_count; ++i)
        add_module(assembly, light_grid_glue_module(&program->light_grids[i]));
    for (size_t i = 0; i < program->light_grid_count; ++i)
        light_grid_glue_write_lookup(generate(assembly), &program->light_grids[i]);
}

// Adds what is about a spot and a stretch of a ray.
static void add_spot(struct assembly *assembly)
{
    const struct scene_features *features = &assembly->model->features;

    if (features->has_peaks || features->places_points || features->is_walked)
        add_module(assembly, "light/spot_lit.glsl");
    if (features->has_peaks) add_module(assembly, "light/spot_segment.glsl");
}

static void add_lights(struct assembly *assembly)
{
    const struct scene *scene = &assembly->model->job->scene;
    const struct scene_features *features = &assembly->model->features;

    scene_modules_add_lights(&assembly->text, assembly->model);
    if (features->has_peaks) {
        add_module(assembly, "math/arc.glsl");
        add_module(assembly, "light/point_segment.glsl");
    }
    for (size_t i = 0; i < scene->light_count; ++i)
        if (features->light_is_seen[i] && light_kind_of(&scene->lights[i])->is_spot) add_spot(assembly);
    if (features->has_extinction && !features->is_tracked && !features->is_walked)
        add_module(assembly, integrator_to_lights(assembly->model)->module);
    scene_glue_write_lights(generate(assembly), assembly->model);
    if (features->has_light_grids && features->is_walked) add_module(assembly, "transmittance/cached.glsl");
    if (features->has_light_grids) add_light_grids(assembly);
    if (features->has_objects && !features->is_walked) scene_glue_write_shadow(assembly->text.out, assembly->model);
}

// Adds how marches resume and stop.
static void add_slices(struct assembly *assembly)
{
    if (!assembly->model->features.is_sliced) {
        add_module(assembly, "integrator/whole.glsl");
        return;
    }
    add_module(assembly, "path/iterations.glsl");
    scene_glue_write_slice_random(generate(assembly), assembly->model);
    add_module(assembly, "integrator/sliced.glsl");
    scene_glue_write_slice(generate(assembly), assembly->model);
}

// Adds random paths in place of an integrator.
static void add_walk(struct assembly *assembly)
{
    const struct scene_model *model = assembly->model;

    scene_modules_add_draws(&assembly->text, model);
    add_module(assembly, "light/sample.glsl");
    add_module(assembly, "path/iterations.glsl");
    add_module(assembly, "scatter/random.glsl");
    add_module(assembly, "scatter/ray.glsl");
    add_module(assembly, "math/arc.glsl");
    add_module(assembly, "scatter/near.glsl");
    if (model->features.has_objects) scene_glue_write_albedo(generate(assembly), model);
    add_module(assembly, model->features.has_objects ? "scatter/vertex_surfaces.glsl" : "scatter/vertex_media.glsl");
    if (scene_glue_walk_has_aims(model)) add_module(assembly, "scatter/aim.glsl");
    scene_glue_write_walk(generate(assembly), model);
    scene_glue_write_walk_lights(assembly->text.out, model);
    if (scene_glue_walk_knows_lamps(model)) scene_glue_write_walk_lamps(assembly->text.out, model);
    if (scene_glue_walk_sends(model)) scene_glue_write_walk_aside(assembly->text.out, model);
    add_module(assembly, scene_glue_walk_sends(model) ? "scatter/aside.glsl" : "scatter/no_aside.glsl");
    scene_glue_write_walk_aim(generate(assembly), model);
    scene_glue_write_walk_start(assembly->text.out);
    add_module(assembly, "scatter/sum.glsl");
    add_module(assembly, "scatter/walk.glsl");
}

static void add_scatter_grid(struct assembly *assembly)
{
    add_module(assembly, "math/march.glsl");
    add_module(assembly, "scatter_grid/lookup.glsl");
    scatter_grid_glue_write_lookup(generate(assembly), assembly->program->scatter_grid, assembly->model);
}

static void add_integrator(struct assembly *assembly)
{
    if (assembly->model->features.is_walked) {
        add_walk(assembly);
        return;
    }
    if (assembly->model->features.has_scatter_grid) add_scatter_grid(assembly);
    if (assembly->model->features.places_points) add_placement(assembly);
    if (assembly->model->features.has_roulette) add_module(assembly, "integrator/roulette.glsl");
    if (assembly->model->features.is_gauss) {
        add_module(assembly, "math/segment.glsl");
        add_module(assembly, "math/gauss.glsl");
    }
    scene_glue_write_gather(generate(assembly), assembly->model);
    if (assembly->model->features.marches) add_slices(assembly);
    if (assembly->model->features.marches && !assembly->model->features.is_tracked)
        scene_glue_write_step_limit(generate(assembly), assembly->model);
    add_module(assembly, integrator_of(assembly->model)->along_rays.module);
}

static void add_shape(struct assembly *assembly, enum scene_shape_kind kind)
{
    static const char *const regions[] = {[SCENE_SHAPE_SPHERE] = "region/sphere.glsl",
                                          [SCENE_SHAPE_BOX] = "region/box.glsl",
                                          [SCENE_SHAPE_PLANE] = "region/plane.glsl"};
    static const char *const normals[] = {
        [SCENE_SHAPE_SPHERE] = "surface/sphere.glsl", [SCENE_SHAPE_BOX] = "surface/box.glsl"};

    add_module(assembly, regions[kind]);
    if (kind != SCENE_SHAPE_PLANE) add_module(assembly, normals[kind]);
}

static void add_optics(struct assembly *assembly, const struct scene_material *material,
                       const struct object_features *object)
{
    static const char *const fresnels[] = {[SCENE_FRESNEL_EXACT] = "surface/fresnel_exact.glsl",
                                           [SCENE_FRESNEL_SCHLICK] = "surface/fresnel_schlick.glsl",
                                           [SCENE_FRESNEL_NONE] = "surface/fresnel_none.glsl"};

    if (object->has_fresnel) {
        add_module(assembly, "surface/snell.glsl");
        add_module(assembly, fresnels[material->fresnel]);
    }
    if (object->is_rough) add_module(assembly, "surface/rough.glsl");
}

static void add_texture(struct assembly *assembly, size_t i)
{
    for (const char *const *name = texture_glue_modules(assembly->model->job, i); *name; ++name)
        add_module(assembly, *name);
    texture_glue_write(generate(assembly), assembly->model, i);
}

static void add_surfaces(struct assembly *assembly)
{
    const struct scene *scene = &assembly->model->job->scene;
    const struct scene_features *features = &assembly->model->features;

    for (size_t i = 0; i < scene->shape_count; ++i)
        add_shape(assembly, scene->shapes[i].kind);
    for (size_t i = 0; i < scene->object_count; ++i)
        add_optics(assembly, &scene->objects[i].material, &features->objects[i]);
    add_module(assembly, "surface/crossing.glsl");
    scene_glue_write_surfaces(generate(assembly), assembly->model);
    add_module(assembly, "surface/visible.glsl");
    for (size_t i = 0; i < scene->object_count; ++i)
        if (features->surfaces_are_lit && scene->objects[i].material.texture.file) add_texture(assembly, i);
}

static void add_path(struct assembly *assembly)
{
    const struct scene_features *features = &assembly->model->features;

    scene_glue_write_seen(generate(assembly), assembly->model);
    add_module(assembly, "path/ray.glsl");
    if (features->has_paths) {
        add_module(assembly, features->has_two_paths ? "path/stack.glsl" : "path/single.glsl");
        add_module(assembly, "path/send.glsl");
    }
    scene_glue_write_path(generate(assembly), assembly->model);
    add_module(assembly, "path/follow.glsl");
    if (features->has_paths) add_module(assembly, "path/trace.glsl");
    add_module(assembly, "path/iterations.glsl");
}

static bool assemble(struct scene_program *program, const char *shader_dir, struct error *error)
{
    struct assembly assembly = {.program = program, .model = &program->model};
    struct shader_assembly *text = &assembly.text;

    if (!shader_assembly_begin(text, shader_dir, error)) return false;
    fputs("#version 450 core\n", text->out);
    add_module(&assembly, "math/constants.glsl");
    add_module(&assembly, program->model.features.is_rgb ? "math/spectrum_rgb.glsl" : "math/spectrum_grey.glsl");
    frame_uniforms_declare(&program->uniforms, generate(&assembly));
    if (program->model.features.has_rays) add_camera(&assembly);
    if (program->model.features.has_media) add_media(&assembly);
    if (program->model.features.has_objects) add_surfaces(&assembly);
    if (program->model.features.has_lights) add_lights(&assembly);
    if (program->model.features.has_media) add_integrator(&assembly);
    if (program->model.features.has_objects && !program->model.features.is_walked) add_path(&assembly);
    scene_glue_write_main(generate(&assembly), &program->model, program->uniforms.size_bytes > 0);
    memcpy(program->module_names, text->module_names, sizeof program->module_names);
    program->module_count = text->module_count;
    program->fragment = shader_assembly_end(text);
    return program->fragment != NULL;
}

// Adds the grids of baked densities.
static bool add_baked(struct scene_program *program, const char *shader_dir, struct error *error)
{
    struct density_bake bake;

    for (size_t i = 0; i < program->model.features.medium_count; ++i) {
        const struct density_site site = scene_model_site(&program->model, i);

        if (!program->model.features.media[i].is_seen || !density_bake_find(&bake, program->model.job, i)) continue;
        if (!density_fill_add_caches(program->caches, &program->cache_count, &site, shader_dir, error)) return false;
    }
    return true;
}

// Returns the caches that are there and that other caches may read.
static uint64_t find_kept(const struct scene_program *program)
{
    uint64_t kept = 0;

    for (size_t i = 0; i < program->cache_count; ++i)
        if (!program->caches[i].is_step) kept |= (uint64_t)1 << i;
    return kept;
}

// Adds the grid of each light that is visible to a model, the picture's or its walks': where its nodes lie, and the
// programs that fill it.
static bool add_grids(struct scene_program *program, const struct scene_model *model, const char *shader_dir,
                      struct error *error)
{
    uint64_t densities = find_kept(program);

    if (!model->features.has_light_grids) return true;
    program->light_grids = xcalloc(scene_features_count_marched(&model->features) + 1, sizeof *program->light_grids);
    for (size_t i = 0; i < model->job->scene.light_count; ++i) {
        struct light_grid *grid = &program->light_grids[program->light_grid_count];

        if (!model->features.light_is_marched[i]) continue;
        light_grid_init(grid, model, i);
        grid->densities = densities;
        if (model == &program->model) light_grid_add_values(&program->uniforms, grid, grid->light);
        if (!light_grid_glue_add_caches(program->caches, &program->cache_count, grid, model, shader_dir, error))
            return false;
        program->light_grid_count++;
    }
    return true;
}

// Returns the model of the walks that fill the grid of scattered light. Light from lights comes to them by light grids,
// if necessary from their own.
static struct scene_model walked_model(struct scene_program *program)
{
    struct scene_model model;
    bool is_from_lights = program->scatter_grid->is_from_lights;
    struct job *job = program->walked = xmalloc(sizeof *program->walked);
    size_t marched = 0;

    *job = *program->model.job;
    if (job->quality.method != JOB_METHOD_CACHED)
        job->quality.light_grid = scatter_grid_light_cells(program->scatter_grid);
    job->quality.method = JOB_METHOD_TRACKING;
    job->quality.estimator = JOB_ESTIMATOR_RATIO;
    job->quality.roulette_below = 0;
    job->quality.scatter_grid = 0;
    scene_model_init(&model, job, program->model.inputs);
    model.features.fills_grid = model.features.is_tracked = model.features.has_majorants = true;
    model.features.is_rgb = program->model.features.is_rgb;
    for (size_t i = 0; i < model.features.medium_count; ++i)
        marched += medium_features_march_to_lights(&model.features.media[i]);
    model.features.has_light_grids =
        !is_from_lights && model.features.marches_to_lights && marched <= JOB_CACHED_MEDIUM_LIMIT;
    model.features.estimates_columns =
        !is_from_lights && model.features.marches_to_lights && !model.features.has_light_grids;
    model.features.has_samples = model.features.is_random = model.features.has_background = false;
    model.features.has_depth = model.features.has_transmittance = false;
    return model;
}

// Fails for what the grid does not hold.
static bool check_scattered(const struct scene_program *program, struct error *error)
{
    if (!scatter_grid_check_size(program->scatter_grid, error)) return false;
    if (scatter_grid_is_similar(program->scatter_grid) && program->walked_model.features.estimates_columns) {
        error_set(error, "quality.similar_after: only where at most %d media are marched towards lights",
                  JOB_CACHED_MEDIUM_LIMIT);
        return false;
    }
    if (!program->scatter_grid->is_from_lights || !program->model.features.has_emission) return true;
    error_set(error, "quality.scatter_from: expected \"nodes\", since media emit light");
    return false;
}

// Adds the grid of scattered light, which is filled through a model of its own.
static bool add_scattered(struct scene_program *program, const char *shader_dir, struct error *error)
{
    size_t own = program->cache_count, filled;

    if (!program->model.features.has_scatter_grid) return true;
    program->scatter_grid = xcalloc(1, sizeof *program->scatter_grid);
    if (!scatter_grid_init(program->scatter_grid, &program->model)) {
        error_set(error, "quality.scatter_grid: expected media that end, by bounds or by their grid's box");
        return false;
    }
    program->walked_model = walked_model(program);
    if (!check_scattered(program, error)) return false;
    scatter_grid_add_values(&program->uniforms, program->scatter_grid);
    if (program->light_grid_count == 0 && !program->scatter_grid->is_from_lights &&
        !add_grids(program, &program->walked_model, shader_dir, error))
        return false;
    filled = program->cache_count;
    if (!scatter_grid_glue_add_caches(program->caches, &program->cache_count,
                                      &(struct scatter_grid_program){.grid = program->scatter_grid,
                                                                     .walked = &program->walked_model,
                                                                     .light_grids = program->light_grids,
                                                                     .light_grid_count = program->light_grid_count,
                                                                     .reads = find_kept(program)},
                                      shader_dir, error))
        return false;
    for (size_t i = own; i < filled; ++i)
        program->caches[i].is_step = true;
    return true;
}

static void hash_texts(struct scene_program *program)
{
    char hashes[2 + SCENE_CACHE_LIMIT][HASH_TEXT_SIZE];

    hash_bytes(program->vertex, strlen(program->vertex), hashes[0]);
    hash_bytes(program->fragment, strlen(program->fragment), hashes[1]);
    for (size_t i = 0; i < program->cache_count; ++i)
        scene_cache_hash(&program->caches[i], hashes[2 + i]);
    hash_bytes(hashes, 2 * sizeof *hashes, program->text_hash);
    hash_bytes(hashes, (2 + program->cache_count) * sizeof *hashes, program->hash);
}

static bool init(struct scene_program *program, const struct job *job, const struct scene_inputs *inputs,
                 bool is_sliced, const char *shader_dir, struct error *error)
{
    struct camera_view view;

    *program = (struct scene_program){0};
    scene_model_init(&program->model, job, inputs);
    program->model.features.is_sliced = is_sliced;
    if (!camera_view_init(&view, &job->scene.camera, job_frame_time(job, frame_range_at(&job->frames, 0)),
                          job->width_px, job->height_px, error))
        return false;
    scene_values_add(&program->uniforms, &program->model);
    program->vertex = shader_sources_load(shader_dir, "fullscreen.vert", error);
    if (!program->vertex || !add_baked(program, shader_dir, error) ||
        !add_grids(program, &program->model, shader_dir, error) || !add_scattered(program, shader_dir, error) ||
        !assemble(program, shader_dir, error)) {
        scene_program_finish(program);
        return false;
    }
    hash_texts(program);
    return true;
}

bool scene_program_init(struct scene_program *program, const struct job *job, const struct scene_inputs *inputs,
                        const char *shader_dir, struct error *error)
{
    return init(program, job, inputs, false, shader_dir, error);
}

bool scene_program_init_sliced(struct scene_program *program, const struct job *job, const struct scene_inputs *inputs,
                               const char *shader_dir, struct error *error)
{
    return init(program, job, inputs, true, shader_dir, error);
}

void scene_program_finish(struct scene_program *program)
{
    for (size_t i = 0; i < program->cache_count; ++i)
        scene_cache_finish(&program->caches[i]);
    free(program->light_grids);
    free(program->scatter_grid);
    free(program->walked);
    frame_uniforms_finish(&program->uniforms);
    free(program->vertex);
    free(program->fragment);
    *program = (struct scene_program){0};
}
