// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/scene_guards.h"

#include "core/base/alloc.h"
#include "core/job/job.h"
#include "core/scene/light_rules.h"
#include "worker/scene/camera_view.h"
#include "worker/scene/media_extent.h"
#include "worker/scene/pixel_samples.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
    LAMP_REACH = 3, // steps around a lamp: light about it is as steep on every level
    LINE_REACH = 1,
    CORNER_COUNT = 8,
    CHORD_PX = 8, // of an outline's polygon
    CHORD_LEAST = 16,
    CHORD_MOST = 1024,
    NARROW_STEPS = 4 // a medium whose picture is narrower is guarded
};

static const double NEAR = 1e-6; // m ahead of the camera: what is nearer has no place in the picture
static const double TURN = 6.283185307179586;

// A moment of a frame.
struct moment {
    struct scene_guards *guards;
    const struct job *job;
    struct camera_view view;
    double time;
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Metres to the right, up and ahead.
static void find_seen(const struct camera_view *view, const double point[3], double seen[3])
{
    const double *axes[3] = {view->right, view->up, view->forward};
    double from[3];

    for (int i = 0; i < 3; i++)
        from[i] = point[i] - view->position[i];
    for (int i = 0; i < 3; i++)
        seen[i] = dot(from, axes[i]);
}

static void find_pixel(const struct moment *moment, const double seen[3], double pixel[2])
{
    const struct camera_view *view = &moment->view;

    pixel[0] = 0.5 * (1.0 + seen[0] / (seen[2] * view->half_width)) * moment->job->width_px - 0.5;
    pixel[1] = 0.5 * (1.0 - seen[1] / (seen[2] * view->half_height)) * moment->job->height_px - 0.5;
}

// Both ends as find_seen has them. The part behind the camera is left out.
static void add_line(const struct moment *moment, const double from[3], const double to[3], int reach)
{
    struct scene_guards *guards = moment->guards;
    struct pixel_guard guard = {.reach = reach};
    double ends[2][3];

    memcpy(ends[0], from, sizeof ends[0]);
    memcpy(ends[1], to, sizeof ends[1]);
    if (ends[0][2] < NEAR && ends[1][2] < NEAR) return;
    for (int end = 0; end < 2; end++) {
        double ahead = ends[1 - end][2] - ends[end][2], share = (NEAR - ends[end][2]) / ahead;

        if (ends[end][2] >= NEAR) continue;
        for (int i = 0; i < 3; i++)
            ends[end][i] += share * (ends[1 - end][i] - ends[end][i]);
        ends[end][2] = NEAR;
    }
    find_pixel(moment, ends[0], guard.from);
    find_pixel(moment, ends[1], guard.to);
    guards->list = xgrow(guards->list, &guards->capacity, guards->count + 1, sizeof *guards->list);
    guards->list[guards->count++] = guard;
}

static void add_lamps(const struct moment *moment)
{
    const struct scene *scene = &moment->job->scene;

    for (size_t i = 0; i < scene->light_count; i++) {
        double position[3], seen[3];

        if (!light_rules_of(scene->lights[i].kind)->has_position) continue;
        timeline_evaluate(&scene->lights[i].position, moment->time, position);
        find_seen(&moment->view, position, seen);
        if (seen[2] >= NEAR) add_line(moment, seen, seen, LAMP_REACH);
    }
}

// The size in the picture of something so large, at the distance of its middle, px.
static double find_size_px(const struct moment *moment, double size, double distance)
{
    return distance > 0.0 ? size / distance / (2.0 * moment->view.half_height) * moment->job->height_px : INFINITY;
}

static bool is_narrow(const struct moment *moment, double size, double distance)
{
    return find_size_px(moment, size, distance) < NARROW_STEPS * moment->job->quality.pixels.stride;
}

// The circle in which the cone of tangents from the camera touches the sphere.
static void add_sphere(const struct moment *moment, const double center[3], double radius)
{
    double seen[3], distance, middle[3], across[3] = {0}, down[3], length, circle, chords;
    int least = 0, chord_count;

    find_seen(&moment->view, center, seen);
    distance = sqrt(dot(seen, seen));
    if (!(radius > 0.0) || !(distance > radius)) return;
    for (int i = 1; i < 3; i++)
        if (fabs(seen[i]) < fabs(seen[least])) least = i;
    across[least] = 1.0;
    length = seen[least] / (distance * distance);
    for (int i = 0; i < 3; i++) {
        middle[i] = seen[i] * (1.0 - radius * radius / (distance * distance));
        across[i] -= length * seen[i];
    }
    length = sqrt(dot(across, across));
    circle = radius * sqrt(1.0 - radius * radius / (distance * distance));
    for (int i = 0; i < 3; i++)
        across[i] *= circle / length;
    for (int i = 0; i < 3; i++)
        down[i] = (seen[(i + 1) % 3] * across[(i + 2) % 3] - seen[(i + 2) % 3] * across[(i + 1) % 3]) / distance;
    chords = TURN * find_size_px(moment, circle, distance) / CHORD_PX;
    chord_count = (int)fmin(fmax(chords, CHORD_LEAST), CHORD_MOST);
    for (int k = 0; k < chord_count; k++) {
        double ends[2][3];

        for (int end = 0; end < 2; end++)
            for (int i = 0; i < 3; i++)
                ends[end][i] = middle[i] + cos(TURN * (k + end) / chord_count) * across[i] +
                               sin(TURN * (k + end) / chord_count) * down[i];
        add_line(moment, ends[0], ends[1], LINE_REACH);
    }
}

static void add_box(const struct moment *moment, const double low[3], const double high[3])
{
    double corners[CORNER_COUNT][3];

    for (int corner = 0; corner < CORNER_COUNT; corner++) {
        const double point[3] = {corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1],
                                 corner & 4 ? high[2] : low[2]};

        find_seen(&moment->view, point, corners[corner]);
    }
    for (int corner = 0; corner < CORNER_COUNT; corner++)
        for (int axis = 1; axis <= 4; axis *= 2)
            if (!(corner & axis)) add_line(moment, corners[corner], corners[corner | axis], LINE_REACH);
}

static void add_shape(const struct moment *moment, const struct scene_shape *shape)
{
    double center[3], size[3], low[3], high[3];

    timeline_evaluate(&shape->center, moment->time, center);
    switch (shape->kind) {
    case SCENE_SHAPE_SPHERE:
        timeline_evaluate(&shape->radius, moment->time, size);
        add_sphere(moment, center, size[0]);
        break;
    case SCENE_SHAPE_BOX:
        timeline_evaluate(&shape->size, moment->time, size);
        for (int i = 0; i < 3; i++) {
            low[i] = center[i] - 0.5 * size[i];
            high[i] = center[i] + 0.5 * size[i];
        }
        add_box(moment, low, high);
        break;
    case SCENE_SHAPE_PLANE:
        break;
    }
}

static void add_medium(const struct moment *moment, const struct scene_inputs *inputs, size_t medium)
{
    const struct scene_density *density = &moment->job->scene.media[medium].density;
    struct media_extent extent = media_extent_of(moment->job, inputs, medium, moment->time);
    bool is_sharp = scene_density_is_even(density);
    double middle[3], seen[3], least = INFINITY;

    if (extent.has_ball) {
        find_seen(&moment->view, extent.center, seen);
        if (is_sharp || is_narrow(moment, 2.0 * extent.radius, sqrt(dot(seen, seen))))
            add_sphere(moment, extent.center, extent.radius);
    }
    if (!extent.has_box) return;
    for (int i = 0; i < 3; i++) {
        middle[i] = 0.5 * (extent.low[i] + extent.high[i]);
        least = fmin(least, extent.high[i] - extent.low[i]);
    }
    find_seen(&moment->view, middle, seen);
    if (is_sharp || is_narrow(moment, least, sqrt(dot(seen, seen)))) add_box(moment, extent.low, extent.high);
}

int scene_guards_find_moments(const struct job *job, int32_t frame, double times[static SCENE_GUARD_MOMENTS])
{
    int samples = pixel_samples_count(job), count = samples < SCENE_GUARD_MOMENTS ? samples : SCENE_GUARD_MOMENTS;

    if (scene_is_constant(&job->scene)) count = 1;
    for (int i = 0; i < count; i++)
        times[i] = pixel_samples_time(job, frame, count > 1 ? i * (samples - 1) / (count - 1) : 0);
    return count;
}

void scene_guards_init(struct scene_guards *guards, const struct job *job, const struct scene_inputs *inputs,
                       int32_t frame)
{
    const struct scene *scene = &job->scene;
    double times[SCENE_GUARD_MOMENTS];
    int count = scene_guards_find_moments(job, frame, times);

    *guards = (struct scene_guards){0};
    for (int i = 0; i < count; i++) {
        struct moment moment = {.guards = guards, .job = job, .time = times[i]};

        if (!camera_view_init(&moment.view, &scene->camera, moment.time, job->width_px, job->height_px, NULL)) continue;
        add_lamps(&moment);
        for (size_t k = 0; k < scene->shape_count; k++)
            add_shape(&moment, &scene->shapes[k]);
        for (size_t k = 0; k < scene->medium_count; k++)
            add_medium(&moment, inputs, k);
    }
}

void scene_guards_finish(struct scene_guards *guards)
{
    free(guards->list);
    *guards = (struct scene_guards){0};
}
