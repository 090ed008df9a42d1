// SPDX-License-Identifier: Apache-2.0
#include "core/job/step_check.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/scene/light_rules.h"
#include "core/scene/scene_diameter.h"
#include "core/scene/scene_nodes.h"

#include <math.h>
#include <string.h>

// The input of the checks of a method.
struct check {
    const struct job *job;
    const struct json_node *document, *quality;
    struct timeline_span span;
    struct error *error;
};

// The longest straight line through a medium, m.
static double medium_diameter(const struct check *check, const struct scene_medium *medium)
{
    const struct scene *scene = &check->job->scene;
    double diameter = scene_diameter_of_density(&medium->density, check->span);

    if (medium->owner == 0) return diameter;
    return fmin(diameter, scene_diameter_of_object(scene, &scene->objects[medium->owner - 1], check->span));
}

// The path of parallel light through a slab, m.
static double slab_path(const struct scene_bounds *slab, const struct scene_light *light, struct timeline_span span)
{
    double normal[3], direction[3], dot = 0.0, normal_square = 0.0, direction_square = 0.0;

    if (!timeline_is_constant(&slab->normal) || !timeline_is_constant(&light->direction)) return INFINITY;
    timeline_evaluate(&slab->normal, span.first, normal);
    timeline_evaluate(&light->direction, span.first, direction);
    for (int i = 0; i < 3; i++) {
        dot += normal[i] * direction[i];
        normal_square += normal[i] * normal[i];
        direction_square += direction[i] * direction[i];
    }
    return timeline_find_largest(&slab->thickness, span) * sqrt(normal_square) * sqrt(direction_square) / fabs(dot);
}

// An upper bound of the distance from a point light to a sample, m: by way of the camera.
static double point_distance(const struct check *check, const struct scene_light *light)
{
    const struct scene_camera *camera = &check->job->scene.camera;
    double light_min[3], light_max[3], camera_min[3], camera_max[3], extent[3];

    timeline_find_bounds(&light->position, check->span, light_min, light_max);
    timeline_find_bounds(&camera->position, check->span, camera_min, camera_max);
    for (int i = 0; i < 3; i++)
        extent[i] = fmax(light_max[i] - camera_min[i], camera_max[i] - light_min[i]);
    return hypot(hypot(extent[0], extent[1]), extent[2]) + camera->clip_far;
}

// An upper bound of the distance from a point light to a shape, m.
static double shape_distance(const struct check *check, const struct scene_shape *shape,
                             const struct scene_light *light)
{
    double light_min[3], light_max[3], min[3], max[3], extent[3];

    timeline_find_bounds(&light->position, check->span, light_min, light_max);
    timeline_find_bounds(&shape->center, check->span, min, max);
    for (int i = 0; i < 3; i++)
        extent[i] = fmax(light_max[i] - min[i], max[i] - light_min[i]);
    return hypot(hypot(extent[0], extent[1]), extent[2]) + scene_diameter_of_shape(shape, check->span) / 2.0;
}

// An upper bound of the distance from a point light to a surface that it lights, m. (camera.clip bounds only media.)
static double surface_distance(const struct check *check, const struct scene_light *light)
{
    const struct scene *scene = &check->job->scene;
    double longest = 0.0;

    for (size_t i = 0; i < scene->object_count; i++) {
        const struct scene_object *object = &scene->objects[i];

        if (object->material.kind != SCENE_MATERIAL_DIFFUSE) continue;
        for (size_t k = 0; k < object->shape_count; k++)
            longest = fmax(longest, shape_distance(check, &scene->shapes[object->first_shape + k], light));
    }
    return longest;
}

static double light_path(const struct check *check, const struct scene_medium *medium, const struct scene_light *light)
{
    const struct scene_bounds *bounds = &medium->density.bounds;
    double diameter = medium_diameter(check, medium);

    if (light_rules_of(light->kind)->has_position)
        return fmin(diameter, fmax(point_distance(check, light), surface_distance(check, light)));
    if (bounds->kind == SCENE_BOUNDS_SLAB) return fmin(diameter, slab_path(bounds, light, check->span));
    return diameter;
}

struct march {
    double length, step; // m
    const char *along;
    int step_limit;
};

static bool check_count(const struct json_node *node, const struct march *march, struct error *error)
{
    double count = ceil(march->length / march->step - 1e-9);

    if (count <= march->step_limit) return true;
    return json_fail(node, error, "expected at most %d steps along a ray, got %.10g: %.10g m %s in steps of %.10g m",
                     march->step_limit, count, march->length, march->along, march->step);
}

// The node of a medium's density, and its parents.
struct density_nodes {
    struct scene_nodes medium;
    struct json_node density;
};

static const struct json_node *find_density(const struct check *check, size_t index, struct density_nodes *nodes)
{
    nodes->density =
        json_node_child(scene_nodes_find_medium(&nodes->medium, check->document, &check->job->scene, index), "density");
    return &nodes->density;
}

enum { ALONG_SIZE = 64 };

static const char *describe_path(const struct check *check, size_t index, char along[static ALONG_SIZE])
{
    static const char through[] = "through ";

    strcpy(along, through);
    scene_format_medium_place(&check->job->scene, index, along + strlen(through), ALONG_SIZE - strlen(through));
    return along;
}

// Whether marches go to the light: random paths find those of many directions.
static bool is_marched_to(const struct scene_light *light)
{
    return !light_rules_of(light->kind)->has_size;
}

static bool has_marched_lights(const struct scene *scene)
{
    for (size_t i = 0; i < scene->light_count; i++)
        if (is_marched_to(&scene->lights[i])) return true;
    return false;
}

// The longest path of a light through a medium, m; an unbounded one is an error.
static bool find_light_path(const struct check *check, size_t index, double *longest)
{
    const struct scene *scene = &check->job->scene;
    struct density_nodes nodes;

    *longest = 0.0;
    for (size_t i = 0; i < scene->light_count; i++) {
        double path =
            is_marched_to(&scene->lights[i]) ? light_path(check, &scene->media[index], &scene->lights[i]) : 0.0;

        if (isinf(path))
            return json_fail(find_density(check, index, &nodes), check->error,
                             "expected bounds (a sphere or a box): the path of lights[%zu] through it has no end", i);
        *longest = fmax(*longest, path);
    }
    return true;
}

static bool check_light_march(const struct check *check, size_t index)
{
    struct json_node node = json_node_child(check->quality, "light_step");
    double longest;
    char along[ALONG_SIZE];

    if (!find_light_path(check, index, &longest)) return false;
    if (check->job->quality.light_step == 0.0) return true;
    return check_count(&node,
                       &(struct march){longest, check->job->quality.light_step, describe_path(check, index, along),
                                       JOB_MARCH_STEPS_LIMIT},
                       check->error);
}

// Whether a parallel light has a path through the medium that has no end, wherever camera.clip ends.
static bool has_endless_sun(const struct check *check, size_t index)
{
    const struct scene *scene = &check->job->scene;

    for (size_t i = 0; i < scene->light_count; i++)
        if (is_marched_to(&scene->lights[i]) && !light_rules_of(scene->lights[i].kind)->has_position &&
            isinf(light_path(check, &scene->media[index], &scene->lights[i])))
            return true;
    return false;
}

static bool check_march(const struct check *check, size_t index)
{
    const struct scene *scene = &check->job->scene;
    double clip = scene->camera.clip_far - scene->camera.clip_near;
    double length = fmin(medium_diameter(check, &scene->media[index]), clip);
    struct json_node node = json_node_child(check->quality, "step");
    struct density_nodes nodes;
    char along[ALONG_SIZE];

    if (isinf(length))
        return json_fail(find_density(check, index, &nodes), check->error,
                         "expected bounds (a sphere or a box)%s: a march through it has no end",
                         has_endless_sun(check, index) ? "" : " or a camera.clip that ends");
    if (check->job->quality.step == 0.0) return true;
    return check_count(&node,
                       &(struct march){length, check->job->quality.step, describe_path(check, index, along),
                                       job_find_step_limit(check->job)},
                       check->error);
}

static bool has_grid(const struct scene *scene)
{
    for (size_t i = 0; i < scene->medium_count; i++)
        if (scene->media[i].density.kind == SCENE_DENSITY_GRID) return true;
    return false;
}

static bool check_voxels(const struct check *check)
{
    static const char *const keys[] = {"step_voxels", "light_step_voxels"};

    for (int i = 0; i < 2; i++) {
        struct json_node node = json_node_child(check->quality, keys[i]);

        if (!json_node_is_absent(&node) && !has_grid(&check->job->scene))
            return json_fail(&node, check->error,
                             "expected a density of kind \"grid\", whose voxels it counts, got none");
    }
    return true;
}

static bool check_no_objects(const struct check *check)
{
    struct json_node method = json_node_child(check->quality, "method");

    if (check->job->scene.object_count == 0) return true;
    return json_fail(&method, check->error,
                     "expected a method that renders objects (midpoint or, in homogeneous media, equiangular), got %s",
                     job_method_name(check->job->quality.method));
}

static const char *describe_light_grids(const struct job *job)
{
    return job->quality.method == JOB_METHOD_CACHED ? "cached" : "a light_grid";
}

// Each light has a grid around the media of varying density, with a channel for each of them.
static bool check_light_grids(const struct check *check)
{
    const struct scene *scene = &check->job->scene;
    struct json_node method = json_node_child(check->quality, "method");
    size_t count = 0;

    for (size_t i = 0; i < scene->medium_count && has_marched_lights(scene); i++) {
        const struct scene_density *density = &scene->media[i].density;
        struct density_nodes nodes;

        if (scene_density_is_even(density)) continue;
        if (++count > JOB_CACHED_MEDIUM_LIMIT)
            return json_fail(&method, check->error, "expected at most %d media whose density varies with %s",
                             JOB_CACHED_MEDIUM_LIMIT, describe_light_grids(check->job));
        if (density->kind != SCENE_DENSITY_GRID && isinf(scene_diameter_of_density(density, check->span)))
            return json_fail(find_density(check, i, &nodes), check->error,
                             "expected bounds (a sphere or a box): with %s each light has a grid around it",
                             describe_light_grids(check->job));
    }
    return true;
}

static bool check_cached(const struct check *check)
{
    const struct scene *scene = &check->job->scene;

    if (!check_voxels(check) || !check_no_objects(check) || !check_light_grids(check)) return false;
    for (size_t i = 0; i < scene->medium_count; i++)
        if (scene->media[i].density.kind != SCENE_DENSITY_GRID &&
            (has_marched_lights(scene) || !scene_media_are_even(scene)) && !check_march(check, i))
            return false;
    return true;
}

// Checks methods that take steps. Auto and draft have no steps yet.
static bool check_midpoint(const struct check *check)
{
    const struct scene *scene = &check->job->scene;
    const struct job_quality *quality = &check->job->quality;
    struct json_node light_step = json_node_child(check->quality, "light_step");
    bool is_even = scene_media_are_even(scene);

    if (!check_voxels(check)) return false;
    if (!is_even && job_quality_states_method(quality) && !job_quality_has_majorants(quality) &&
        has_marched_lights(scene) && quality->light_step == 0.0 && quality->light_step_voxels == 0.0)
        return json_fail_expected(&light_step, check->error, "a number of metres, as light marches through media");
    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct scene_density *density = &scene->media[i].density;

        if (density->kind == SCENE_DENSITY_GRID || (is_even && !has_marched_lights(scene))) continue;
        if (!check_march(check, i) || (!scene_density_is_even(density) && !check_light_march(check, i))) return false;
    }
    return true;
}

// Only the job itself can state a majorant of its own code.
static bool check_majorant(const struct check *check, size_t index)
{
    const struct scene_density *density = &check->job->scene.media[index].density;
    struct density_nodes nodes;
    struct json_node node = json_node_child(find_density(check, index, &nodes), "majorant");

    if (density->kind != SCENE_DENSITY_GLSL || density->glsl.majorant > 0.0) return true;
    return json_fail_expected(&node, check->error,
                              "an upper bound of density(), which the estimators delta and ratio need");
}

static bool check_tracking(const struct check *check)
{
    const struct scene *scene = &check->job->scene;

    if (!check_no_objects(check)) return false;
    for (size_t i = 0; i < scene->medium_count && job_quality_has_majorants(&check->job->quality); i++)
        if (!check_majorant(check, i)) return false;
    return check_midpoint(check);
}

static bool check_riemann(const struct check *check)
{
    const struct scene *scene = &check->job->scene;
    struct json_node step = json_node_child(check->quality, "step"), method = json_node_child(check->quality, "method");
    double length = scene->camera.clip_far - scene->camera.clip_near;

    if (!check_no_objects(check)) return false;
    if (!isfinite(length))
        return json_fail(&method, check->error,
                         "riemann needs camera.clip: it steps from the near to the far distance");
    if (round(length / check->job->quality.step) < 1.0)
        return json_fail(&step, check->error, "expected at most the %.10g m between the clip distances, got %.10g",
                         length, check->job->quality.step);
    for (size_t i = 0; i < scene->medium_count; i++) {
        double longest;

        if (scene->media[i].density.kind != SCENE_DENSITY_GRID && !find_light_path(check, i, &longest)) return false;
    }
    return check_count(&step,
                       &(struct march){length, check->job->quality.step, "between the clip distances",
                                       job_find_step_limit(check->job)},
                       check->error);
}

// The bounds of n media cut a ray into at most 2 n - 1 intervals; each light has its points in each of them.
static bool check_points(const struct check *check)
{
    const struct scene *scene = &check->job->scene;
    struct json_node points = json_node_child(check->quality, "points");
    int limit;

    if (scene->medium_count == 0 || !has_marched_lights(scene)) return true;
    limit = JOB_MARCH_STEPS_LIMIT / (int)(scene->light_count * (2 * scene->medium_count - 1));
    if (check->job->quality.points <= limit) return true;
    return json_fail(&points, check->error, "expected at most %d with %zu lights and %zu media, got %d", limit,
                     scene->light_count, scene->medium_count, check->job->quality.points);
}

static bool check_equiangular(const struct check *check)
{
    const struct scene *scene = &check->job->scene;

    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct scene_density *density = &scene->media[i].density;
        struct density_nodes nodes;
        const struct json_node *node = find_density(check, i, &nodes);
        struct json_node kind = json_node_child(node, "kind"), bounds = json_node_child(node, "bounds");
        struct json_node falloff = json_node_child(&bounds, "falloff");

        if (density->kind != SCENE_DENSITY_HOMOGENEOUS)
            return json_fail_expected(&kind, check->error, "\"homogeneous\", which equiangular needs everywhere");
        if (!scene_density_is_even(density))
            return json_fail_expected(&falloff, check->error, "0, which equiangular needs");
    }
    return check_points(check);
}

// Random paths take no steps, but may have light grids.
static bool check_paths(const struct check *check)
{
    struct json_node grid = json_node_child(check->quality, "light_grid");

    if (check->job->quality.light_grid == 0) return true;
    if (!has_marched_lights(&check->job->scene))
        return json_fail(&grid, check->error, "only for a sun, a point or a spot: paths lead to other lights");
    if (scene_media_are_even(&check->job->scene))
        return json_fail(&grid, check->error, "only where a density varies: what reaches others is known exactly");
    return check_light_grids(check);
}

bool step_check(const struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node quality = json_node_child(document, "quality");
    const struct check check = {job, document, &quality, job_time_span(job), error};

    switch (job->quality.method) {
    case JOB_METHOD_RIEMANN:
        return check_riemann(&check);
    case JOB_METHOD_MIDPOINT:
    case JOB_METHOD_JITTERED:
    case JOB_METHOD_ADAPTIVE:
    case JOB_METHOD_GAUSS:
    case JOB_METHOD_PREINTEGRATED:
        return check_midpoint(&check);
    case JOB_METHOD_TRACKING:
        return check_tracking(&check);
    case JOB_METHOD_CACHED:
        return check_cached(&check);
    case JOB_METHOD_EQUIANGULAR:
        return check_equiangular(&check);
    case JOB_METHOD_PATHS:
        return check_paths(&check); // and scattering_check
    case JOB_METHOD_AUTO:
    case JOB_METHOD_DRAFT: // homogeneous media alone need no steps, nor do paths
        return scene_media_are_even(&job->scene) || (job->scene.orders > 1 && !step_has_end(job)) ||
               check_midpoint(&check);
    }
    return false;
}

bool step_has_end(const struct job *job)
{
    const struct scene *scene = &job->scene;
    const struct check check = {.job = job, .span = job_time_span(job)};
    double clip = scene->camera.clip_far - scene->camera.clip_near;

    for (size_t i = 0; i < scene->medium_count && !scene_media_are_even(scene); i++) {
        const struct scene_medium *medium = &scene->media[i];

        if (medium->density.kind == SCENE_DENSITY_GRID) continue;
        if (isinf(fmin(medium_diameter(&check, medium), clip))) return false;
        for (size_t k = 0; k < scene->light_count && !scene_density_is_even(&medium->density); k++)
            if (is_marched_to(&scene->lights[k]) && isinf(light_path(&check, medium, &scene->lights[k]))) return false;
    }
    return true;
}

double step_longest_path(const struct job *job)
{
    const struct check check = {.job = job, .span = job_time_span(job)};
    double clip = job->scene.camera.clip_far - job->scene.camera.clip_near, longest = 0.0;

    for (size_t i = 0; i < job->scene.medium_count; i++) {
        const struct scene_medium *medium = &job->scene.media[i];

        if (medium->density.kind != SCENE_DENSITY_GRID)
            longest = fmax(longest, fmin(medium_diameter(&check, medium), clip));
    }
    return longest;
}

double step_smallest_diameter(const struct job *job)
{
    const struct check check = {.job = job, .span = job_time_span(job)};
    double smallest = INFINITY;

    for (size_t i = 0; i < job->scene.medium_count; i++) {
        const struct scene_medium *medium = &job->scene.media[i];

        if (medium->density.kind != SCENE_DENSITY_GRID && !scene_density_is_even(&medium->density))
            smallest = fmin(smallest, medium_diameter(&check, medium));
    }
    return smallest;
}
