// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_lookup.h"

#include <math.h>

// Another machine's exp2 may round otherwise.
static bool is_equal(double a, double b)
{
    static const double ROUNDING = 1e-12;

    return fabs(a - b) <= ROUNDING * fabs(a);
}

static bool has_equal_steps(const struct job_quality *a, const struct job_quality *b)
{
    return is_equal(a->step, b->step) && is_equal(a->step_voxels, b->step_voxels);
}

static bool has_equal_light_steps(const struct job_quality *a, const struct job_quality *b)
{
    return is_equal(a->light_step, b->light_step) && is_equal(a->light_step_voxels, b->light_step_voxels);
}

static bool has_equal_paths(const struct job_quality *a, const struct job_quality *b)
{
    return a->max_depth == b->max_depth && is_equal(a->min_throughput, b->min_throughput);
}

static bool is_on_rung(enum plan_axis axis, const struct job_quality *a, const struct job_quality *b)
{
    switch (axis) {
    case PLAN_AXIS_STEP:
        return has_equal_steps(a, b);
    case PLAN_AXIS_LIGHT_STEP:
        return has_equal_light_steps(a, b);
    case PLAN_AXIS_DEPTH_STEP:
        return is_equal(a->depth_step, b->depth_step);
    case PLAN_AXIS_POINTS:
        return a->points == b->points;
    case PLAN_AXIS_LIGHT_GRID:
        return a->light_grid == b->light_grid;
    case PLAN_AXIS_DENSITY_GRID:
        return a->density_grid == b->density_grid;
    case PLAN_AXIS_MIN_TRANSMITTANCE:
        return is_equal(a->min_transmittance, b->min_transmittance);
    case PLAN_AXIS_PATHS:
        return has_equal_paths(a, b);
    case PLAN_AXIS_SCATTER_GRID:
        return a->scatter_grid == b->scatter_grid;
    case PLAN_AXIS_NODE_PATHS:
    case PLAN_AXIS_PIXEL_PATHS:
        return a->paths == b->paths;
    }
    return false;
}

static bool has_equal_numbers(const struct job_quality *a, const struct job_quality *b)
{
    return a->method == b->method && a->order == b->order && a->points == b->points && a->light_grid == b->light_grid &&
           a->density_grid == b->density_grid && a->scatter_grid == b->scatter_grid &&
           a->scatter_from == b->scatter_from && a->similar_after == b->similar_after && a->paths == b->paths &&
           a->samples == b->samples && a->light_steps == b->light_steps && a->estimator == b->estimator &&
           a->roulette_below == b->roulette_below && a->roulette_survive == b->roulette_survive &&
           has_equal_steps(a, b) && has_equal_light_steps(a, b) && has_equal_paths(a, b) &&
           is_equal(a->depth_step, b->depth_step) && is_equal(a->min_transmittance, b->min_transmittance);
}

static bool find_point(const struct plan_family *family, const struct plan_scene *scene,
                       const struct job_quality *quality, struct plan_point *point)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_family_axes(family, scene, axes);
    struct job_quality found;

    *point = (struct plan_point){.is_from_lights = quality->scatter_from == JOB_SCATTER_FROM_LIGHTS};
    for (int i = 0; i < count; i++) {
        int last = plan_axis_last_rung(axes[i], scene);

        for (;; point->rungs[i]++) {
            found = plan_family_quality(family, scene, point);
            if (is_on_rung(axes[i], quality, &found)) break;
            if (point->rungs[i] == last) return false;
        }
    }
    found = plan_family_quality(family, scene, point);
    return has_equal_numbers(quality, &found);
}

bool plan_lookup(const struct plan_scene *scene, const struct job_quality *quality, size_t *family,
                 struct plan_point *point)
{
    struct job_quality own = *quality;

    // What plan_apply adds is of no family.
    if (own.method == JOB_METHOD_PATHS) own.step = own.step_voxels = 0.0;
    for (*family = 0; *family < plan_family_count; ++*family)
        if (plan_family_serves(&plan_families[*family], scene) &&
            find_point(&plan_families[*family], scene, &own, point))
            return true;
    return false;
}
