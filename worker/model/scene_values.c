// SPDX-License-Identifier: Apache-2.0
#include "worker/model/scene_values.h"

#include "core/job/job.h"
#include "worker/density/scene_bounds.h"
#include "worker/glsl/scene_anchor.h"
#include "worker/glsl/timeline_value.h"
#include "worker/model/light_kind.h"
#include "worker/model/object_values.h"
#include "worker/model/scene_model.h"
#include "worker/scene/camera_view.h"
#include "worker/scene/pixel_samples.h"

#include <math.h>
#include <string.h>

static const double largest_g = 0.99999;

static void evaluate_sigma_t(const void *source, double time, double value[static 9])
{
    const struct scene_medium *medium = source;
    double sigma_s[9] = {0}, sigma_a[9] = {0};

    timeline_value_evaluate(&medium->sigma_s, time, sigma_s);
    timeline_value_evaluate(&medium->sigma_a, time, sigma_a);
    for (int i = 0; i < 3; ++i)
        value[i] = sigma_s[i] + sigma_a[i];
}

static void evaluate_one(const void *source, double time, double value[static 9])
{
    (void)source;
    (void)time;
    value[0] = value[1] = value[2] = 1;
}

static void evaluate_number(const void *source, double time, double value[static 9])
{
    (void)time;
    value[0] = *(const double *)source;
}

static void evaluate_count(const void *source, double time, double value[static 9])
{
    (void)time;
    value[0] = *(const int *)source;
}

// The paths of one pass.
static void evaluate_paths(const void *source, double time, double value[static 9])
{
    const struct job *job = source;
    int samples = pixel_samples_count(job);

    (void)time;
    value[0] = ceil((double)job->quality.paths / samples);
}

// The steps of riemann: counted in double precision, because drivers round half a step differently.
static void evaluate_step_count(const void *source, double time, double value[static 9])
{
    const struct job *job = source;

    (void)time;
    value[0] = round((job->scene.camera.clip_far - job->scene.camera.clip_near) / job->quality.step);
}

static void evaluate_camera_position(const void *source, double time, double value[static 9])
{
    const struct job *job = source;

    timeline_evaluate(&job->scene.camera.position, time, value);
}

// Computes scale_right and scale_up times the image's axes, plus `ahead` metres forward. A camera without a view gives
// NaN, which packing refuses.
static void combine_axes(const struct job *job, double time, double scale_right, double scale_up, double ahead,
                         double value[static 9])
{
    struct camera_view view;

    if (!camera_view_init(&view, &job->scene.camera, time, job->width_px, job->height_px, NULL)) {
        value[0] = value[1] = value[2] = NAN;
        return;
    }
    for (int i = 0; i < 3; ++i)
        value[i] = scale_right * view.half_width * view.right[i] + scale_up * view.half_height * view.up[i] +
                   ahead * view.forward[i];
}

static void evaluate_camera_corner(const void *source, double time, double value[static 9])
{
    combine_axes(source, time, -1, 1, 1, value);
}

static void evaluate_camera_across(const void *source, double time, double value[static 9])
{
    const struct job *job = source;

    combine_axes(job, time, 2.0 / job->width_px, 0, 0, value);
}

static void evaluate_camera_down(const void *source, double time, double value[static 9])
{
    const struct job *job = source;

    combine_axes(job, time, 0, -2.0 / job->height_px, 0, value);
}

// Without a view there is only the camera's position.
static void add_camera(struct frame_uniforms *uniforms, const struct job *job, bool has_view)
{
    static const struct {
        const char *name;
        frame_value_evaluate *evaluate;
    } values[] = {{"camera_position", evaluate_camera_position},
                  {"camera_corner", evaluate_camera_corner},
                  {"camera_across", evaluate_camera_across},
                  {"camera_down", evaluate_camera_down}};
    const struct scene_camera *camera = &job->scene.camera;
    bool position_is_fixed = timeline_is_constant(&camera->position);
    bool view_is_fixed = position_is_fixed && timeline_is_constant(&camera->target) &&
                         timeline_is_constant(&camera->up) && timeline_is_constant(&camera->fov);

    for (size_t i = 0; i < (has_view ? sizeof values / sizeof *values : 1); ++i)
        frame_uniforms_add(uniforms,
                           (struct frame_value){.type = FRAME_VALUE_VEC3,
                                                .is_constant = i == 0 ? position_is_fixed : view_is_fixed,
                                                .evaluate = values[i].evaluate,
                                                .is_position = i == 0,
                                                .source = job,
                                                .min = value_range_any.min,
                                                .max = value_range_any.max,
                                                .meaning = "camera"},
                           "%s", values[i].name);
}

static void add_lobes(struct frame_uniforms *uniforms, const struct scene_medium *medium,
                      const struct medium_features *features, size_t index)
{
    const struct value_range gs = {-largest_g, largest_g};
    static const struct value_range weights = {0, 1};

    for (size_t i = 0; i < medium->lobe_count; ++i) {
        if (features->lobes[i] == LOBE_UNSEEN) continue;
        if (features->lobes[i] == LOBE_HENYEY_GREENSTEIN)
            frame_uniforms_add(uniforms, timeline_value(&medium->lobes[i].g, FRAME_VALUE_FLOAT, gs, "phase.g"),
                               "medium_%zu_lobe_%zu_g", index, i);
        frame_uniforms_add(uniforms,
                           timeline_value(&medium->lobes[i].weight, FRAME_VALUE_FLOAT, weights, "phase.weight"),
                           "medium_%zu_lobe_%zu_weight", index, i);
    }
}

// The density of a transfer function is the extinction itself.
static struct frame_value sigma_t_of(const struct scene_medium *medium, const struct medium_features *features,
                                     enum frame_value_type spectrum)
{
    return (struct frame_value){.type = spectrum,
                                .is_constant = features->has_color || (timeline_is_constant(&medium->sigma_s) &&
                                                                       timeline_is_constant(&medium->sigma_a)),
                                .evaluate = features->has_color ? evaluate_one : evaluate_sigma_t,
                                .source = medium,
                                .min = value_range_not_negative.min,
                                .max = value_range_not_negative.max,
                                .meaning = "sigma_s + sigma_a"};
}

// Adds the values of a medium's density and bounds.
static void add_density(struct frame_uniforms *uniforms, const struct density_site *site)
{
    density_kind_of(&site->source->density)->add_values(uniforms, site);
    scene_bounds_add_values(uniforms, &site->source->density.bounds, site->medium);
}

static void add_medium(struct frame_uniforms *uniforms, const struct scene_model *model, enum frame_value_type spectrum,
                       size_t i)
{
    const struct medium_features *features = &model->features.media[i];
    const struct density_site site = scene_model_site(model, i);
    const struct scene_medium *medium = site.source;

    add_density(uniforms, &site);
    if (model->features.has_majorants && density_kind_of(&medium->density)->add_majorant)
        density_kind_of(&medium->density)->add_majorant(uniforms, &site);
    if (medium_features_have_column(features))
        frame_uniforms_add(uniforms, sigma_t_of(medium, features, spectrum), "medium_%zu_sigma_t", i);
    if (features->emits)
        frame_uniforms_add(uniforms, timeline_value(&medium->emission, spectrum, value_range_not_negative, "emission"),
                           "medium_%zu_emission", i);
    if (!features->scatters || !(model->features.has_lights || model->features.is_walked ||
                                 model->features.has_scatter_grid || model->features.fills_grid))
        return;
    frame_uniforms_add(uniforms, timeline_value(&medium->sigma_s, spectrum, value_range_not_negative, "sigma_s"),
                       "medium_%zu_sigma_s", i);
    add_lobes(uniforms, medium, features, i);
}

static void add_light(struct frame_uniforms *uniforms, const struct scene_light *light, enum frame_value_type spectrum,
                      size_t index)
{
    frame_uniforms_add(uniforms,
                       timeline_value(&light->intensity, spectrum, value_range_not_negative, "lights.intensity"),
                       "light_%zu_intensity", index);
    light_kind_add_values(uniforms, &(struct light_site){light, index, spectrum});
}

// A number of a setting is a uniform, so that all settings of a method share one program.
static void add_setting(struct frame_uniforms *uniforms, frame_value_evaluate *evaluate, const void *source,
                        const char *meaning)
{
    frame_uniforms_add(uniforms,
                       (struct frame_value){.type = FRAME_VALUE_FLOAT,
                                            .origin = FRAME_VALUE_OF_PLAN,
                                            .evaluate = evaluate,
                                            .source = source,
                                            .min = value_range_not_negative.min,
                                            .max = value_range_not_negative.max,
                                            .meaning = meaning},
                       "%s", meaning);
}

static void add_number(struct frame_uniforms *uniforms, const double *number, const char *meaning)
{
    add_setting(uniforms, evaluate_number, number, meaning);
}

// A whole number below 2^24, which floats hold exactly.
static void add_count(struct frame_uniforms *uniforms, const int *count, const char *meaning)
{
    add_setting(uniforms, evaluate_count, count, meaning);
}

static void evaluate_sample_columns(const void *source, double time, double value[static 9])
{
    int columns, rows;

    (void)time;
    pixel_samples_strata(pixel_samples_count(source), &columns, &rows);
    value[0] = columns;
}

static void evaluate_sample_rows(const void *source, double time, double value[static 9])
{
    int columns, rows;

    (void)time;
    pixel_samples_strata(pixel_samples_count(source), &columns, &rows);
    value[0] = rows;
}

// Adds the number that tells a picture's random paths from those that a plan is made by.
static void add_stream(struct frame_uniforms *uniforms)
{
    const struct frame_value stream = {.type = FRAME_VALUE_FLOAT,
                                       .origin = FRAME_VALUE_STREAM,
                                       .max = value_range_any.max,
                                       .meaning = "the stream of random numbers"};

    frame_uniforms_add(uniforms, stream, "random_stream");
}

// Spheres and domes with an image are drawn at random, by a shader that may not use it.
static bool has_random_lights(const struct scene *scene, const struct scene_features *features)
{
    for (size_t i = 0; i < scene->light_count; ++i)
        if (features->light_is_seen[i] &&
            (light_kind_of(&scene->lights[i])->is_sphere || light_kind_of(&scene->lights[i])->has_image))
            return true;
    return false;
}

// Adds whole numbers, which floats hold exactly.
static void add_sampling(struct frame_uniforms *uniforms, const struct job *job, const struct scene_features *features)
{
    const struct frame_value seed = {.type = FRAME_VALUE_FLOAT,
                                     .origin = FRAME_VALUE_FRAME_SEED,
                                     .is_constant = scene_is_constant(&job->scene),
                                     .max = FRAME_NUMBER_LIMIT,
                                     .meaning = "the frame's number"};
    const struct frame_value sample = {.type = FRAME_VALUE_FLOAT,
                                       .origin = FRAME_VALUE_SAMPLE_INDEX,
                                       .is_constant = !features->has_samples,
                                       .max = value_range_any.max,
                                       .meaning = "quality.samples"};

    if (features->is_walked || features->fills_grid || has_random_lights(&job->scene, features)) add_stream(uniforms);
    if (!features->is_random) return;
    frame_uniforms_add(uniforms, seed, "frame_seed");
    frame_uniforms_add(uniforms, sample, "sample_index");
    if (!features->has_samples) return;
    add_setting(uniforms, evaluate_sample_columns, job, "sample_columns");
    add_setting(uniforms, evaluate_sample_rows, job, "sample_rows");
}

static void add_riemann(struct frame_uniforms *uniforms, const struct scene_model *model)
{
    add_setting(uniforms, evaluate_step_count, model->job, "quality_step_count");
    if (model->features.marches_to_lights) add_count(uniforms, &model->job->quality.light_steps, "quality_light_steps");
}

static void add_steps(struct frame_uniforms *uniforms, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    const struct job_quality *quality = scene_model_quality(model);

    if (features->marches && !features->has_majorants) add_number(uniforms, &quality->step, "quality_step");
    if (features->marches_to_lights && !features->has_light_grids && !features->has_majorants)
        add_number(uniforms, &quality->light_step, "quality_light_step");
    if (features->is_adaptive) add_number(uniforms, &quality->depth_step, "quality_depth_step");
    if (features->is_walked) add_setting(uniforms, evaluate_paths, model->job, "quality_paths");
    if (features->has_media && !features->is_walked &&
        (features->has_objects || (features->has_throughput && !features->is_tracked)))
        add_number(uniforms, &quality->min_transmittance, "quality_min_transmittance");
    if (quality->method == JOB_METHOD_RIEMANN && features->marches) add_riemann(uniforms, model);
    if (features->has_roulette) {
        add_number(uniforms, &quality->roulette_below, "quality_roulette_below");
        add_number(uniforms, &quality->roulette_survive, "quality_roulette_survive");
    }
    if (features->has_paths) {
        add_number(uniforms, &quality->min_throughput, "quality_min_throughput");
        add_count(uniforms, &quality->max_depth, "quality_max_depth");
    }
}

static void evaluate_anchor(const void *source, double time, double value[static 9])
{
    scene_anchor_find(source, time, value);
}

// Adds the anchor, for densities that are functions of the world's coordinates.
static void add_anchor(struct frame_uniforms *uniforms, const struct scene_model *model)
{
    const struct job *job = model->job;
    bool is_taken = false;

    for (size_t i = 0; i < job->scene.medium_count; ++i)
        is_taken |= model->features.media[i].is_seen && density_kind_of(&job->scene.media[i].density)->takes_anchor;
    if (!is_taken || !scene_anchor_is_used(job)) return;
    frame_uniforms_add(uniforms,
                       (struct frame_value){.type = FRAME_VALUE_VEC3,
                                            .is_constant = !scene_anchor_moves(job),
                                            .evaluate = evaluate_anchor,
                                            .source = job,
                                            .min = value_range_any.min,
                                            .max = value_range_any.max,
                                            .meaning = "camera.position"},
                       "scene_anchor");
}

void scene_values_add_densities(struct frame_uniforms *uniforms, const struct scene_model *model)
{
    uniforms->anchored = model->job;
    if (model->features.takes_time) frame_uniforms_add(uniforms, timeline_value_time(), "time_s");
    add_anchor(uniforms, model);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        const struct density_site site = scene_model_site(model, i);

        if (model->features.media[i].is_seen) add_density(uniforms, &site);
    }
}

void scene_values_add(struct frame_uniforms *uniforms, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    enum frame_value_type spectrum = features->is_rgb ? FRAME_VALUE_VEC3 : FRAME_VALUE_FLOAT;
    const struct scene *scene = &model->job->scene;

    uniforms->anchored = model->job;
    if (features->has_rays) add_camera(uniforms, model->job, !features->fills_grid);
    if (features->takes_time) frame_uniforms_add(uniforms, timeline_value_time(), "time_s");
    add_anchor(uniforms, model);
    for (size_t i = 0; i < scene->medium_count; ++i)
        if (features->media[i].is_seen) add_medium(uniforms, model, spectrum, i);
    object_values_add(uniforms, scene, features, spectrum);
    for (size_t i = 0; i < scene->light_count; ++i)
        if (features->light_is_seen[i]) add_light(uniforms, &scene->lights[i], spectrum, i);
    if (features->has_background && !features->dome_is_behind)
        frame_uniforms_add(uniforms,
                           timeline_value(&scene->background, spectrum, value_range_not_negative, "background"),
                           "background");
    add_sampling(uniforms, model->job, features);
    add_steps(uniforms, model);
}
