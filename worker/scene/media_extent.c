// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/media_extent.h"

#include "core/job/job.h"
#include "worker/scene/scene_inputs.h"

#include <math.h>
#include <string.h>

static double number_at(const struct timeline *timeline, double time)
{
    double value[9] = {0};

    timeline_evaluate(timeline, time, value);
    return value[0];
}

static void add_ball(struct media_extent *extent, const double center[3], double radius)
{
    if (extent->has_ball && extent->radius <= radius) return;
    extent->has_ball = true;
    memcpy(extent->center, center, sizeof extent->center);
    extent->radius = fmax(radius, 0);
}

static void add_box(struct media_extent *extent, const double low[3], const double high[3])
{
    for (int i = 0; i < 3; ++i) {
        extent->low[i] = extent->has_box ? fmax(extent->low[i], low[i]) : low[i];
        extent->high[i] = fmax(extent->has_box ? fmin(extent->high[i], high[i]) : high[i], extent->low[i]);
    }
    extent->has_box = true;
}

static void add_bounds(struct media_extent *extent, const struct scene_bounds *bounds, double time)
{
    double center[9] = {0}, size[9] = {0}, low[3], high[3];

    switch (bounds->kind) {
    case SCENE_BOUNDS_SPHERE:
        timeline_evaluate(&bounds->center, time, center);
        add_ball(extent, center, number_at(&bounds->radius, time));
        break;
    case SCENE_BOUNDS_BOX:
        timeline_evaluate(&bounds->center, time, center);
        timeline_evaluate(&bounds->size, time, size);
        for (int i = 0; i < 3; ++i) {
            low[i] = center[i] - 0.5 * size[i];
            high[i] = center[i] + 0.5 * size[i];
        }
        add_box(extent, low, high);
        break;
    case SCENE_BOUNDS_NONE:
    case SCENE_BOUNDS_SLAB:
        break;
    }
}

struct media_extent media_extent_of(const struct job *job, const struct scene_inputs *inputs, size_t medium,
                                    double time)
{
    static const double origin[3] = {0};
    const struct scene_density *density = &job->scene.media[medium].density;
    const struct scene_fold_fractal *fractal = &density->fold_fractal;
    struct media_extent extent = {0};

    add_bounds(&extent, &density->bounds, time);
    if (density->kind == SCENE_DENSITY_FOLD_FRACTAL)
        add_ball(&extent, origin,
                 number_at(&fractal->radius, time) +
                     fractal->iterations * sqrt(3) * fabs(number_at(&fractal->offset, time)));
    if (density->kind == SCENE_DENSITY_GRID && inputs && inputs->media[medium].source) {
        double low[3], high[3];

        scene_input_box(&inputs->media[medium], time, low, high);
        add_box(&extent, low, high);
    }
    return extent;
}

struct scene_ball media_extent_ball(const struct job *job, const struct scene_inputs *inputs, size_t medium,
                                    double time)
{
    struct media_extent extent = media_extent_of(job, inputs, medium, time);
    struct scene_ball ball = {.radius = INFINITY}, around_box = {.radius = INFINITY};

    if (extent.has_ball) {
        memcpy(ball.center, extent.center, sizeof ball.center);
        ball.radius = extent.radius;
    }
    if (!extent.has_box) return ball;
    for (int axis = 0; axis < 3; ++axis)
        around_box.center[axis] = 0.5 * (extent.low[axis] + extent.high[axis]);
    around_box.radius = hypot(hypot(extent.high[0] - around_box.center[0], extent.high[1] - around_box.center[1]),
                              extent.high[2] - around_box.center[2]);
    return around_box.radius < ball.radius ? around_box : ball;
}

bool media_extent_is_still(const struct scene_density *density)
{
    const struct scene_bounds *bounds = &density->bounds;
    const struct scene_fold_fractal *fractal = &density->fold_fractal;

    if (density->kind == SCENE_DENSITY_GRID) return false;
    if (density->kind == SCENE_DENSITY_FOLD_FRACTAL &&
        (!timeline_is_constant(&fractal->radius) || !timeline_is_constant(&fractal->offset)))
        return false;
    return bounds->kind == SCENE_BOUNDS_NONE ||
           (timeline_is_constant(&bounds->center) && timeline_is_constant(&bounds->radius) &&
            timeline_is_constant(&bounds->size));
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void find_corner(const struct media_extent *extent, int index, double corner[3])
{
    for (int i = 0; i < 3; ++i)
        corner[i] = index >> i & 1 ? extent->high[i] : extent->low[i];
}

double media_extent_support(const struct media_extent *extent, const double direction[static 3])
{
    double support = INFINITY, farthest = -INFINITY, corner[3];

    if (extent->has_ball) support = dot(extent->center, direction) + extent->radius;
    if (!extent->has_box) return support;
    for (int i = 0; i < 8; ++i) {
        find_corner(extent, i, corner);
        farthest = fmax(farthest, dot(corner, direction));
    }
    return fmin(support, farthest);
}

void media_extent_distances(const struct media_extent *extent, const double from[static 3], double *near, double *far)
{
    double nearest_square = 0, farthest_square = 0;

    *near = 0;
    *far = INFINITY;
    if (extent->has_ball) {
        double distance =
            hypot(hypot(extent->center[0] - from[0], extent->center[1] - from[1]), extent->center[2] - from[2]);

        *near = fmax(distance - extent->radius, 0);
        *far = distance + extent->radius;
    }
    if (!extent->has_box) return;
    for (int i = 0; i < 3; ++i) {
        double below = extent->low[i] - from[i], above = from[i] - extent->high[i];
        double outside = fmax(fmax(below, above), 0), across = fmax(fabs(below), fabs(above));

        nearest_square += outside * outside;
        farthest_square += across * across;
    }
    *near = fmax(*near, sqrt(nearest_square));
    *far = fmin(*far, sqrt(farthest_square));
}

static double tangent_of_ball(const double toward[3], double radius, const double across[3], const double along[3])
{
    double x = dot(toward, across), z = dot(toward, along), distance = hypot(x, z);
    double angle = radius < distance ? atan2(x, z) + asin(radius / distance) : INFINITY;

    return angle < acos(0) ? tan(angle) : INFINITY;
}

double media_extent_tangent(const struct media_extent *extent, const double from[static 3],
                            const double across[static 3], const double along[static 3])
{
    double toward[3], tangent = INFINITY, most = -INFINITY;

    if (extent->has_ball) {
        for (int i = 0; i < 3; ++i)
            toward[i] = extent->center[i] - from[i];
        tangent = tangent_of_ball(toward, extent->radius, across, along);
    }
    if (!extent->has_box) return tangent;
    for (int index = 0; index < 8; ++index) {
        double ahead;

        find_corner(extent, index, toward);
        for (int i = 0; i < 3; ++i)
            toward[i] -= from[i];
        ahead = dot(toward, along);
        most = ahead > 0 ? fmax(most, dot(toward, across) / ahead) : INFINITY;
    }
    return fmin(tangent, most);
}
