// SPDX-License-Identifier: Apache-2.0
#include "worker/model/scene_features.h"

#include "core/job/job.h"
#include "core/job/job_layers.h"
#include "core/scene/light_rules.h"
#include "worker/density/density_kind.h"
#include "worker/glsl/timeline_value.h"
#include "worker/model/light_kind.h"

static enum lobe_feature lobe_feature_of(const struct scene_phase_lobe *lobe)
{
    if (timeline_value_is_zero(&lobe->weight)) return LOBE_UNSEEN;
    if (lobe->kind == SCENE_LOBE_RAYLEIGH) return LOBE_RAYLEIGH;
    return timeline_value_is_zero(&lobe->g) ? LOBE_ISOTROPIC : LOBE_HENYEY_GREENSTEIN;
}

static struct medium_features medium_features_of(const struct scene_medium *medium)
{
    const struct density_kind *kind = density_kind_of(&medium->density);
    const struct scene_bounds *bounds = &medium->density.bounds;
    struct medium_features features = {0};

    if (kind->is_zero(&medium->density)) return features;
    features.has_color = kind->has_color && kind->has_color(&medium->density);
    features.scatters = !features.has_color && !timeline_value_is_zero(&medium->sigma_s);
    features.absorbs = features.has_color || !timeline_value_is_zero(&medium->sigma_a);
    features.emits = medium->has_emission && !timeline_value_is_zero(&medium->emission);
    features.glows = medium->blackbody.grid_name && !timeline_value_is_zero(&medium->blackbody.intensity);
    features.is_seen = features.scatters || features.absorbs || features.emits || features.glows;
    features.has_falloff = bounds->kind != SCENE_BOUNDS_NONE && !timeline_value_is_zero(&bounds->falloff);
    features.is_even = kind->is_even && !features.has_falloff;
    for (size_t i = 0; i < medium->lobe_count; ++i)
        features.lobes[i] = lobe_feature_of(&medium->lobes[i]);
    return features;
}

static bool extinction_is_grey(const struct scene_medium *medium, const struct medium_features *features)
{
    return features->has_color || ((!features->scatters || timeline_value_is_grey(&medium->sigma_s)) &&
                                   (!features->absorbs || timeline_value_is_grey(&medium->sigma_a)));
}

static bool medium_is_grey(const struct scene_medium *medium, const struct medium_features *features)
{
    return !features->has_color && !features->glows && extinction_is_grey(medium, features) &&
           (!features->emits || timeline_value_is_grey(&medium->emission));
}

bool medium_features_have_column(const struct medium_features *medium)
{
    return medium->scatters || medium->absorbs;
}

bool medium_features_march_to_lights(const struct medium_features *medium)
{
    return !medium->is_even && medium_features_have_column(medium);
}

static bool has_table(const struct scene_density *density)
{
    const struct density_kind *kind = density_kind_of(density);

    return kind->has_table && kind->has_table(density);
}

static void add_medium(struct scene_features *features, const struct scene_medium *source, enum job_method method,
                       size_t i)
{
    struct medium_features *medium = &features->media[i];

    *medium = medium_features_of(source);
    medium->is_tabled = medium->is_seen && method == JOB_METHOD_PREINTEGRATED && has_table(&source->density);
    if (!medium->is_seen) return;
    features->has_media = true;
    features->is_tabled |= medium->is_tabled;
    features->has_emission |= medium->emits || medium->glows || medium->has_color;
    features->has_extinction |= medium_features_have_column(medium);
    features->takes_time |= density_kind_of(&source->density)->takes_time;
    features->marches |= !medium->is_even;
    features->marches_to_lights |= medium_features_march_to_lights(medium);
    features->is_rgb |= !medium_is_grey(source, medium);
    features->extinction_is_rgb |= !extinction_is_grey(source, medium);
}

static void add_object(struct scene_features *features, const struct scene_object *source, size_t i)
{
    struct object_features *object = &features->objects[i];

    *object = object_features_of(&source->material);
    features->surfaces_are_lit |= object->is_lit;
    features->has_paths |= object_features_have_paths(object);
    features->has_two_paths |= object->sends_two;
    features->has_dielectrics |= !object->is_opaque;
    features->has_fresnel |= object->has_fresnel;
    features->has_roughness |= object->is_rough;
}

// Finds the visible lights. `scatters`: some medium does.
static void add_lights(struct scene_features *features, const struct scene *scene, bool scatters, bool has_walks)
{
    bool has_marched = false;

    for (size_t i = 0; i < scene->light_count; ++i) {
        bool is_behind = scene->lights[i].dome.is_visible;
        bool is_seen = (scatters || features->surfaces_are_lit || is_behind) && !light_kind_is_dark(&scene->lights[i]);

        features->dome_is_behind |= is_behind && is_seen;
        features->light_is_seen[i] = is_seen;
        features->light_is_marched[i] = is_seen && !light_rules_of(scene->lights[i].kind)->has_size;
        has_marched |= features->light_is_marched[i];
        features->has_lights |= is_seen;
        features->is_rgb |= is_seen && !light_kind_is_grey(&scene->lights[i]);
    }
    features->has_background |= features->dome_is_behind;
    features->media_are_lit = scatters && (has_walks ? features->has_lights : has_marched);
    features->surfaces_are_lit &= has_walks ? features->has_lights : has_marched;
    for (size_t i = 0; i < features->object_count; ++i)
        features->is_rgb |=
            !features->objects[i].is_grey && (!features->objects[i].is_lit || features->surfaces_are_lit);
}

static void add_tracking(struct scene_features *features, const struct job_quality *quality)
{
    features->is_tracked = features->marches && quality->method == JOB_METHOD_TRACKING;
    features->has_majorants = features->is_tracked && job_quality_has_majorants(quality);
    for (size_t i = 0; i < features->medium_count; ++i)
        features->estimates_columns |= features->is_tracked && (features->has_lights || !features->has_majorants) &&
                                       medium_features_march_to_lights(&features->media[i]);
}

// Paths replace marches of every kind.
static void add_walk(struct scene_features *features, const struct job *job)
{
    bool has_marched = scene_features_count_marched(features) > 0;

    features->is_scattered = job_layers_are_two(job);
    if (features->is_scattered) features->has_background = features->dome_is_behind = false;
    if (job->quality.method != JOB_METHOD_PATHS || features->medium_count == 0) return;
    // Without a medium that is seen, an empty one is there.
    if (!features->has_media && features->has_objects) features->has_media = features->media[0].is_seen = true;
    if (!features->has_media) return;
    features->is_walked = features->has_majorants = true;
    // Surfaces scatter what media emit, too.
    for (size_t i = 0; i < features->object_count; ++i) {
        features->surfaces_are_lit |= features->objects[i].is_lit;
        features->is_rgb |= features->objects[i].is_lit && !features->objects[i].is_grey;
    }
    features->tracks_to_lights = features->marches_to_lights;
    features->has_light_grids = features->tracks_to_lights && has_marched && job->quality.light_grid > 0;
    features->marches = features->marches_to_lights = false;
}

struct scene_features scene_features_of(const struct job *job, const bool *is_unneeded)
{
    const struct scene *scene = &job->scene;
    struct scene_features features = {.medium_count = scene->medium_count,
                                      .object_count = scene->object_count,
                                      .has_objects = scene->object_count > 0,
                                      .has_depth = job->output.has_depth,
                                      .has_transmittance = job->output.has_transmittance,
                                      .has_background =
                                          scene->has_background && !timeline_value_is_zero(&scene->background)};
    bool scatters = false;

    for (size_t i = 0; i < scene->medium_count; ++i) {
        if (!is_unneeded || !is_unneeded[i]) add_medium(&features, &scene->media[i], job->quality.method, i);
        scatters |= features.media[i].scatters;
    }
    for (size_t i = 0; i < scene->object_count; ++i)
        add_object(&features, &scene->objects[i], i);
    add_lights(&features, scene, scatters, job->quality.method == JOB_METHOD_PATHS);
    features.has_scatter_grid = job->quality.scatter_grid > 0 && scene->orders > 1 && scatters &&
                                (features.has_lights || features.has_emission);
    features.marches_to_lights &= features.has_lights;
    features.has_light_grids = features.marches_to_lights && job->quality.method == JOB_METHOD_CACHED;
    features.places_points =
        (features.media_are_lit || features.has_scatter_grid) && job->quality.method == JOB_METHOD_EQUIANGULAR;
    // A Riemann sum is defined by its samples, homogeneous media or not.
    features.marches |=
        features.has_media &&
        (job->quality.method == JOB_METHOD_RIEMANN ||
         (job_method_takes_steps(job->quality.method) && (features.media_are_lit || features.has_scatter_grid)));
    features.is_jittered = features.marches && job->quality.method == JOB_METHOD_JITTERED;
    features.is_adaptive = features.marches && features.has_extinction && job->quality.depth_step > 0;
    features.is_gauss = features.marches && job->quality.method == JOB_METHOD_GAUSS;
    add_tracking(&features, &job->quality);
    add_walk(&features, job);
    features.is_rgb |=
        features.has_background && !features.dome_is_behind && !timeline_value_is_grey(&scene->background);
    for (size_t i = 0; i < scene->light_count; ++i)
        features.has_peaks |= features.light_is_marched[i] && light_kind_of(&scene->lights[i])->is_inverse_square;
    features.has_peaks &=
        features.marches && features.media_are_lit && !features.is_tracked && job->quality.method != JOB_METHOD_RIEMANN;
    features.has_throughput = features.has_extinction || (features.has_media && features.has_objects);
    features.has_rays = features.has_media || features.has_objects || features.dome_is_behind;
    features.has_samples = features.has_rays && job->quality.samples > 1;
    features.has_roulette = features.marches && features.has_extinction && job->quality.roulette_below > 0;
    features.is_random = features.has_samples || features.has_roulette || features.has_roughness ||
                         features.is_jittered || features.is_tracked || features.is_walked;
    return features;
}

bool scene_features_can_be_sliced(const struct scene_features *features)
{
    return features->marches && !features->has_objects && !features->is_tabled;
}

size_t scene_features_count_lights(const struct scene_features *features)
{
    size_t count = 0;

    for (size_t i = 0; i < SCENE_LIGHT_LIMIT; ++i)
        count += features->light_is_seen[i];
    return count;
}

size_t scene_features_count_marched(const struct scene_features *features)
{
    size_t count = 0;

    for (size_t i = 0; i < SCENE_LIGHT_LIMIT; ++i)
        count += features->light_is_marched[i];
    return count;
}
