// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_warnings.h"

#include "core/job/job.h"
#include "core/scene/density_rules.h"

#include <math.h>
#include <stdio.h>

enum { FRAMES_SEEN = 64, TEXT_SIZE = 256 }; // frames that are looked at, spread evenly over the range
static const double TOLERANCE_PLAUSIBLE = 0.2;

struct view {
    double position[3], right[3], up[3], forward[3]; // unit vectors at right angles
    double tan_x, tan_y;                             // of half the angles of view
    double near, far;                                // m along rays
};

struct ball {
    double center[3], radius; // m
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double product[3])
{
    for (int i = 0; i < 3; i++)
        product[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void normalize(double vector[3])
{
    double length = sqrt(dot(vector, vector));

    for (int i = 0; i < 3; i++)
        vector[i] /= length;
}

static struct view view_at(const struct job *job, double time)
{
    const struct scene_camera *camera = &job->scene.camera;
    struct view view = {.near = camera->clip_near, .far = camera->clip_far};
    double target[3], up[3], fov[3];

    timeline_evaluate(&camera->position, time, view.position);
    timeline_evaluate(&camera->target, time, target);
    timeline_evaluate(&camera->up, time, up);
    timeline_evaluate(&camera->fov, time, fov);
    for (int i = 0; i < 3; i++)
        view.forward[i] = target[i] - view.position[i];
    normalize(view.forward);
    cross(view.forward, up, view.right);
    normalize(view.right);
    cross(view.right, view.forward, view.up);
    view.tan_y = tan(fov[0] / 2.0 * (M_PI / 180.0));
    view.tan_x = view.tan_y * job->width_px / job->height_px;
    return view;
}

// A ball around what the density fills; its radius is infinite where that is unknown.
static struct ball ball_at(const struct scene_density *density, struct timeline_span span, double time)
{
    const struct density_rules *rules = density_rules_of(density);
    struct ball ball = {.radius = INFINITY};
    double size[3], radius[3];

    switch (density->bounds.kind) {
    case SCENE_BOUNDS_SPHERE:
        timeline_evaluate(&density->bounds.center, time, ball.center);
        timeline_evaluate(&density->bounds.radius, time, radius);
        ball.radius = radius[0];
        break;
    case SCENE_BOUNDS_BOX:
        timeline_evaluate(&density->bounds.center, time, ball.center);
        timeline_evaluate(&density->bounds.size, time, size);
        ball.radius = sqrt(dot(size, size)) / 2.0;
        break;
    default:
        if (rules->find_diameter) ball.radius = rules->find_diameter(density, span) / 2.0;
    }
    return ball;
}

static bool sees(const struct view *view, const struct ball *ball)
{
    double from[3], x, y, z, distance;

    for (int i = 0; i < 3; i++)
        from[i] = ball->center[i] - view->position[i];
    distance = sqrt(dot(from, from));
    x = fabs(dot(from, view->right));
    y = fabs(dot(from, view->up));
    z = dot(from, view->forward);
    return distance + ball->radius >= view->near && distance - ball->radius <= view->far && z + ball->radius > 0.0 &&
           (x - z * view->tan_x) / hypot(1.0, view->tan_x) <= ball->radius &&
           (y - z * view->tan_y) / hypot(1.0, view->tan_y) <= ball->radius;
}

static bool is_shown(const struct job *job, const struct scene_density *density)
{
    int64_t count = frame_range_count(&job->frames), seen = count < FRAMES_SEEN ? count : FRAMES_SEEN;

    for (int64_t i = 0; i < seen; i++) {
        int32_t frame = frame_range_at(&job->frames, seen > 1 ? i * (count - 1) / (seen - 1) : 0);
        double time = job_frame_time(job, frame);
        struct view view = view_at(job, time);
        struct ball ball = ball_at(density, job_time_span(job), time);

        if (isinf(ball.radius) || sees(&view, &ball)) return true;
    }
    return false;
}

void job_warnings_find(const struct job *job, job_warnings_on_found *on_found, void *user)
{
    const struct scene *scene = &job->scene;
    char place[64], text[TEXT_SIZE];

    if (job->quality.tolerance > TOLERANCE_PLAUSIBLE) {
        snprintf(text, sizeof text, "quality.tolerance: %g is an error of %g %%; %g is one of %g %%",
                 job->quality.tolerance, 100.0 * job->quality.tolerance, job->quality.tolerance / 100.0,
                 job->quality.tolerance);
        on_found(user, text);
    }
    // What no frame shows may light what frames show.
    for (size_t i = 0; i < scene->medium_count && scene->object_count == 0 && scene->orders <= 1; i++) {
        if (is_shown(job, &scene->media[i].density)) continue;
        scene_format_medium_place(scene, i, place, sizeof place);
        snprintf(text, sizeof text,
                 "%s: no frame shows it: it lies outside of the camera's view or of its clip distances", place);
        on_found(user, text);
    }
}
