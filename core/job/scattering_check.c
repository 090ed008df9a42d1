// SPDX-License-Identifier: Apache-2.0
#include "core/job/scattering_check.h"

#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/scene/density_rules.h"
#include "core/scene/light_rules.h"
#include "core/scene/scene_nodes.h"

// Of what a medium without bounds scatters, the least that it must absorb: a path there is scattered 1e4 times then.
static const double ENDLESS_SHARE = 1e-4;

struct check {
    const struct job *job;
    const struct json_node *document;
    struct json_node quality, lights;
    struct timeline_span span; // the times at which something is seen
    struct error *error;
};

// Fails at a light's key.
static bool fail_light(const struct check *check, size_t index, const char *key, const char *why)
{
    struct json_node light = json_node_element(&check->lights, index), node = json_node_child(&light, key);

    return json_fail(&node, check->error, "%s", why);
}

static bool check_domes(const struct check *check)
{
    const struct scene *scene = &check->job->scene;
    size_t count = 0;

    for (size_t i = 0; i < scene->light_count; i++) {
        if (scene->lights[i].kind != SCENE_LIGHT_DOME) continue;
        if (++count > 1) return fail_light(check, i, "kind", "expected one dome at most, got two");
        if (scene->lights[i].dome.is_visible && scene->has_background)
            return fail_light(check, i, "visible", "not beside a background: both lie behind everything");
    }
    return true;
}

static bool check_sizes(const struct check *check)
{
    const struct job *job = check->job;

    for (size_t i = 0; i < job->scene.light_count; i++)
        if (light_rules_of(job->scene.lights[i].kind)->has_size && job->scene.orders <= 1 &&
            job->quality.method != JOB_METHOD_PATHS)
            return fail_light(check, i, "kind",
                              "its light comes from many directions, and needs quality.method \"paths\", or "
                              "scene.scattering.orders above 1");
    return true;
}

static bool check_method(const struct check *check)
{
    const struct job_quality *quality = &check->job->quality;
    struct json_node method = json_node_child(&check->quality, "method");
    struct json_node grid = json_node_child(&check->quality, "scatter_grid");
    struct json_node similar = json_node_child(&check->quality, "similar_after");
    bool is_open = quality->method == JOB_METHOD_PATHS || !job_quality_states_method(quality);

    if (check->job->scene.orders <= 1)
        return quality->scatter_grid == 0 ||
               json_fail(&grid, check->error, "only where light scatters more than once: scene.scattering");
    if (is_open) return true;
    if (quality->method == JOB_METHOD_RIEMANN || quality->method == JOB_METHOD_PREINTEGRATED ||
        quality->method == JOB_METHOD_TRACKING)
        return json_fail(&method, check->error,
                         "expected one that shows light scattered more than once (paths, or another march with a "
                         "scatter_grid), got %s",
                         job_method_name(quality->method));
    if (quality->similar_after > 0 && check->job->scene.orders != SCENE_ORDERS_ALL)
        return json_fail(&similar, check->error,
                         "only where scene.scattering.orders is \"all\": a scattering in similar media is several");
    return quality->scatter_grid > 0 ||
           json_fail_expected(&grid, check->error,
                              "a number of cells, which a march needs where light scatters more than once (or "
                              "quality.method \"paths\")");
}

static bool is_above_zero(const struct check *check, const struct timeline *timeline)
{
    double least[3], largest[3];

    timeline_find_bounds(timeline, check->span, least, largest);
    for (int i = 0; i < timeline->component_count; i++)
        if (largest[i] > 0.0) return true;
    return false;
}

static bool check_objects(const struct check *check)
{
    static const char why[] =
        "not with random paths, which end at what reflects or refracts as a mirror does: they are "
        "those of quality.method \"paths\" and of scene.scattering.orders above 1";
    const struct scene *scene = &check->job->scene;

    for (size_t i = 0; i < scene->object_count; i++) {
        const struct scene_material *material = &scene->objects[i].material;
        struct scene_nodes nodes;
        const struct json_node *node = scene_nodes_find_material(&nodes, check->document, i);
        struct json_node kind = json_node_child(node, "kind"), specular = json_node_child(node, "specular");

        if (material->kind != SCENE_MATERIAL_DIFFUSE) return json_fail(&kind, check->error, "%s", why);
        if (is_above_zero(check, &material->specular)) return json_fail(&specular, check->error, "%s", why);
    }
    return true;
}

static bool check_majorant(const struct check *check, size_t index)
{
    const struct scene *scene = &check->job->scene;
    const struct scene_density *density = &scene->media[index].density;
    struct scene_nodes nodes;
    struct json_node node = json_node_child(scene_nodes_find_medium(&nodes, check->document, scene, index), "density");
    struct json_node majorant = json_node_child(&node, "majorant");

    return density->kind != SCENE_DENSITY_GLSL || density->glsl.majorant > 0.0 ||
           json_fail_expected(&majorant, check->error, "an upper bound of density(), which random paths need");
}

// Whether in some channel and at some time the medium absorbs less than `share` of what it scatters at most.
static bool absorbs_less(const struct check *check, const struct scene_medium *medium, double share)
{
    double least[3], largest[3], none[3], most[3];

    timeline_find_bounds(&medium->sigma_a, check->span, least, largest);
    timeline_find_bounds(&medium->sigma_s, check->span, none, most);
    for (int i = 0; i < 3; i++) {
        int a = i < medium->sigma_a.component_count ? i : 0, s = i < medium->sigma_s.component_count ? i : 0;

        if (most[s] > 0.0 && least[a] < share * most[s]) return true;
    }
    return false;
}

// Whether the medium emits where, in some channel and at some time, it neither absorbs nor scatters.
static bool glows_through(const struct check *check, const struct scene_medium *medium)
{
    double absorbed[3], scattered[3], most[3];

    if (!medium->has_emission || !is_above_zero(check, &medium->emission)) return false;
    timeline_find_bounds(&medium->sigma_a, check->span, absorbed, most);
    timeline_find_bounds(&medium->sigma_s, check->span, scattered, most);
    for (int i = 0; i < 3; i++) {
        int a = i < medium->sigma_a.component_count ? i : 0, s = i < medium->sigma_s.component_count ? i : 0;

        if (absorbed[a] + scattered[s] <= 0.0) return true;
    }
    return false;
}

static bool is_endless_within(const struct scene_medium *medium, enum scene_bounds_kind bounds)
{
    const struct scene_density *density = &medium->density;

    return density->bounds.kind == bounds && medium->owner == 0 && density->kind != SCENE_DENSITY_GRID &&
           !density_rules_of(density)->find_diameter;
}

// A path that is never absorbed ends when it leaves the media. A grid of scattered light is a box around them.
static bool check_end(const struct check *check, size_t index)
{
    const struct scene *scene = &check->job->scene;
    const struct scene_medium *medium = &scene->media[index];
    bool is_endless = is_endless_within(medium, SCENE_BOUNDS_NONE);
    struct scene_nodes nodes;
    struct json_node node = json_node_child(scene_nodes_find_medium(&nodes, check->document, scene, index), "density");

    if (check->job->quality.scatter_grid > 0 && is_above_zero(check, &medium->sigma_s) &&
        (is_endless || is_endless_within(medium, SCENE_BOUNDS_SLAB)))
        return json_fail(&node, check->error,
                         "expected bounds of a sphere or a box: a scatter_grid is a box around what scatters");
    if (is_endless && glows_through(check, medium))
        return json_fail(&node, check->error,
                         "expected bounds, or a sigma_a above 0: light that a medium without end emits and does not "
                         "absorb has no limit");
    return scene->orders <= 1 || !is_endless || !absorbs_less(check, medium, ENDLESS_SHARE) ||
           json_fail(&node, check->error,
                     "expected bounds, or a sigma_a of at least %g times sigma_s: where hardly anything absorbs light "
                     "and nothing ends, it scatters without end",
                     ENDLESS_SHARE);
}

static bool check_paths(const struct check *check)
{
    const struct job *job = check->job;

    if (job->scene.orders <= 1 && job->quality.method != JOB_METHOD_PATHS) return true;
    if (!check_objects(check)) return false;
    for (size_t i = 0; i < job->scene.medium_count; i++)
        if (!check_majorant(check, i) || !check_end(check, i)) return false;
    return true;
}

static struct check check_of(const struct job *job, const struct json_node *document, struct error *error)
{
    return (struct check){.job = job,
                          .document = document,
                          .quality = json_node_child(document, "quality"),
                          .lights = json_node_child(document, "lights"),
                          .span = job_time_span(job),
                          .error = error};
}

bool scattering_check(const struct job *job, const struct json_node *document, struct error *error)
{
    const struct check check = check_of(job, document, error);

    return check_domes(&check) && check_sizes(&check) && check_paths(&check) && check_method(&check);
}

// Light that media emit comes to a scatter_grid from its nodes alone.
static bool may_emit(const struct check *check)
{
    const struct scene *scene = &check->job->scene;

    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct scene_medium *medium = &scene->media[i];

        if ((medium->has_emission && is_above_zero(check, &medium->emission)) || medium->blackbody.grid_name ||
            (medium->density.kind == SCENE_DENSITY_GRID && medium->density.grid.point_count > 0))
            return true;
    }
    return false;
}

bool scattering_check_is_rendered(const struct job *job, const struct json_node *document, struct error *error)
{
    const struct check check = check_of(job, document, error);
    struct json_node method = json_node_child(&check.quality, "method");
    struct json_node from = json_node_child(&check.quality, "scatter_from");
    bool is_walked = job->scene.orders > 1 || job->quality.method == JOB_METHOD_PATHS;
    // A plan chooses among what is rendered.
    bool is_paths = job->quality.method == JOB_METHOD_PATHS || !job_quality_states_method(&job->quality);

    if (is_walked && job->quality.method == JOB_METHOD_AUTO && scene_find_code(&job->scene))
        return json_fail(&check.quality, error,
                         "expected a method (paths), since nothing measures the error of a density in GLSL above "
                         "order 1");
    if (is_walked && job->scene.object_count > 0 && !is_paths)
        return json_fail(&method, error,
                         "not rendered yet: scenes with objects above order 1, but by \"paths\" (or without a method)");
    if (job->quality.scatter_grid > 0 && job->quality.scatter_from == JOB_SCATTER_FROM_LIGHTS && may_emit(&check))
        return json_fail(&from, error, "not where media emit, whose light comes from the nodes alone");
    for (size_t i = 0; i < job->scene.medium_count; i++)
        if (job->quality.scatter_grid > 0 && job->scene.media[i].density.kind == SCENE_DENSITY_GLSL)
            return json_fail(&method, error, "not rendered yet: a scatter_grid of a density in GLSL");
    for (size_t i = 0; i < job->scene.light_count; i++) {
        const struct scene_light *light = &job->scene.lights[i];
        bool is_even = light->kind == SCENE_LIGHT_DOME && light->dome.kind != SCENE_DOME_FILE;
        bool is_from_lights = job->quality.scatter_from != JOB_SCATTER_FROM_NODES && !may_emit(&check);
        bool is_shown = is_paths || ((is_even || is_from_lights) && job->quality.scatter_grid > 0);

        if (light_rules_of(light->kind)->has_size && !is_shown)
            return fail_light(
                &check, i, "kind",
                "not rendered yet by this method: only paths, or a scatter_grid from the lights, show it");
    }
    return true;
}
