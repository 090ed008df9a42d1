// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/scene_visibility.h"

#include "core/scene/light_rules.h"
#include "worker/scene/camera_view.h"
#include "worker/scene/media_extent.h"
#include "worker/scene/pixel_samples.h"

#include <math.h>
#include <string.h>

// Shaders follow rays in floats: a ray that just misses may hit.
static const double MARGIN = 1e-4;

static double distance_of(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

// True where some camera ray meets the ball within the clip distances: rays fill at most the cone around the image's
// corners.
static bool meets_camera_ray(const struct scene_ball *ball, const struct camera_view *view,
                             const struct scene_camera *camera)
{
    double radius = ball->radius * (1.0 + MARGIN), distance = distance_of(ball->center, view->position), ahead = 0.0;
    double corner = atan(hypot(view->half_width, view->half_height));

    radius += MARGIN * 1e-2 * distance;
    if (!(distance > radius)) return true;
    if (distance - radius > camera->clip_far || distance + radius < camera->clip_near) return false;
    for (int axis = 0; axis < 3; ++axis)
        ahead += (ball->center[axis] - view->position[axis]) * view->forward[axis];
    return acos(fmax(-1.0, fmin(1.0, ahead / distance))) <= corner + asin(radius / distance) + MARGIN;
}

// Returns the distance from a point to the ray that begins at `from`; with `has_end` it ends at `from` + `ray`.
static double distance_to_ray(const double point[3], const double from[3], const double ray[3], bool has_end)
{
    double along = 0.0, square = 0.0, at, nearest[3];

    for (int axis = 0; axis < 3; ++axis) {
        along += (point[axis] - from[axis]) * ray[axis];
        square += ray[axis] * ray[axis];
    }
    at = square > 0.0 ? fmax(along / square, 0.0) : 0.0;
    if (has_end) at = fmin(at, 1.0);
    for (int axis = 0; axis < 3; ++axis)
        nearest[axis] = from[axis] + at * ray[axis];
    return distance_of(point, nearest);
}

// True where a shadow ray from some point of `lit` to the light may meet the ball.
static bool meets_shadow_ray(const struct scene_ball *ball, const struct scene_ball *lit,
                             const struct scene_light *light, double time)
{
    bool has_end = light_rules_of(light->kind)->has_position;
    double ray[3], radius = (ball->radius + lit->radius) * (1.0 + MARGIN);

    if (!isfinite(radius) || light_rules_of(light->kind)->has_size) return true;
    timeline_evaluate(has_end ? &light->position : &light->direction, time, ray);
    for (int axis = 0; axis < 3; ++axis)
        ray[axis] = has_end ? ray[axis] - lit->center[axis] : -ray[axis];
    radius += MARGIN * 1e-2 * distance_of(ball->center, lit->center);
    return !(distance_to_ray(ball->center, lit->center, ray, has_end) > radius);
}

static bool is_between(const struct scene *scene, const struct scene_ball *balls, const bool *is_seen, size_t medium,
                       double time)
{
    for (size_t i = 0; i < scene->medium_count; ++i)
        for (size_t k = 0; is_seen[i] && k < scene->light_count; ++k)
            if (meets_shadow_ray(&balls[medium], &balls[i], &scene->lights[k], time)) return true;
    return false;
}

// Finds a ball around each medium, and whether camera rays may meet it.
static void find_seen(const struct job *job, const struct scene_inputs *inputs, double time, struct scene_ball *balls,
                      bool *is_seen)
{
    const struct scene *scene = &job->scene;
    struct camera_view view;
    bool has_view = camera_view_init(&view, &scene->camera, time, job->width_px, job->height_px, NULL);

    for (size_t i = 0; i < scene->medium_count; ++i) {
        balls[i] = media_extent_ball(job, inputs, i, time);
        is_seen[i] = !has_view || meets_camera_ray(&balls[i], &view, &scene->camera);
    }
}

static void add_moment(const struct job *job, const struct scene_inputs *inputs, double time, bool *is_unneeded)
{
    const struct scene *scene = &job->scene;
    struct scene_ball balls[SCENE_MEDIUM_LIMIT];
    bool is_seen[SCENE_MEDIUM_LIMIT] = {0};

    find_seen(job, inputs, time, balls, is_seen);
    for (size_t i = 0; i < scene->medium_count; ++i)
        if (is_seen[i] || is_between(scene, balls, is_seen, i, time)) is_unneeded[i] = false;
}

void scene_visibility_find(const struct job *job, const struct scene_inputs *inputs, int32_t frame,
                           bool is_unneeded[static SCENE_MEDIUM_LIMIT])
{
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        is_unneeded[i] = i < job->scene.medium_count && job->scene.object_count == 0;
    if (job->scene.object_count > 0) return;
    // Light that is scattered several times comes by every medium.
    if (job->scene.orders > 1) {
        for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
            is_unneeded[i] = false;
        return;
    }
    for (int i = 0; i < pixel_samples_count(job); ++i)
        add_moment(job, inputs, pixel_samples_time(job, frame, i), is_unneeded);
}

void scene_visibility_clear_seen(const struct job *job, const struct scene_inputs *inputs, int32_t frame,
                                 bool is_unseen[static SCENE_MEDIUM_LIMIT])
{
    struct scene_ball balls[SCENE_MEDIUM_LIMIT];
    bool is_seen[SCENE_MEDIUM_LIMIT] = {0};

    find_seen(job, inputs, job_frame_time(job, frame), balls, is_seen);
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        is_unseen[i] = is_unseen[i] && !is_seen[i];
}
