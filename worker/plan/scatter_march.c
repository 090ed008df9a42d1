// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_march.h"

#include "core/base/log.h"
#include "core/job/job.h"
#include "worker/picture/image.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer.h"

#include <math.h>

enum { CELLS = 4, WALKS = 12 }; // rungs: 16 cells of scattered light, 64 walks

struct march {
    const struct scatter_march_params *params;
    const struct plan_family *family;
    struct plan_scene scene;
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int axis_count;
    enum renderer_fault *fault;
    struct error *error;
};

bool scatter_march_has(enum plan_axis axis)
{
    switch (axis) {
    case PLAN_AXIS_STEP:
    case PLAN_AXIS_LIGHT_STEP:
    case PLAN_AXIS_DEPTH_STEP:
    case PLAN_AXIS_POINTS:
    case PLAN_AXIS_LIGHT_GRID:
    case PLAN_AXIS_MIN_TRANSMITTANCE:
        return true;
    case PLAN_AXIS_DENSITY_GRID:
    case PLAN_AXIS_PATHS:
    case PLAN_AXIS_SCATTER_GRID:
    case PLAN_AXIS_NODE_PATHS:
    case PLAN_AXIS_PIXEL_PATHS:
        return false;
    }
    return false;
}

void scatter_march_lighten(const enum plan_axis *axes, int count, struct plan_point *point)
{
    for (int i = 0; i < count; i++) {
        if (axes[i] == PLAN_AXIS_SCATTER_GRID) point->rungs[i] = CELLS;
        if (axes[i] == PLAN_AXIS_NODE_PATHS) point->rungs[i] = WALKS;
    }
}

static bool render(const struct march *march, struct plan_point point, struct image *image)
{
    const struct scatter_march_params *params = march->params;
    struct job planned = *params->job;
    struct renderer_result result = {0};
    bool ok;

    scatter_march_lighten(march->axes, march->axis_count, &point);
    planned.quality = plan_family_quality(march->family, &march->scene, &point);
    planned.quality.samples = 1;
    ok = plan_lattice_render(params->lattice, params->params, &planned, params->frame, image, &result, march->error);
    *march->fault = result.fault;
    return ok;
}

static double find_change(const struct scatter_march_params *params, const struct image *before,
                          const struct image *after)
{
    size_t count = plan_lattice_count(params->lattice);
    double sum = 0.0;

    for (size_t i = 0; i < 4 * count; i++)
        if (i % 4 != 3) sum += pow((double)(before->rgba[i] - after->rgba[i]), 2.0);
    return params->light > 0.0 ? sqrt(sum / (3.0 * (double)count) / params->light) : 0.0;
}

// `before` is the picture at the point, and stays that.
static bool refine_axis(const struct march *march, int axis, struct plan_point *point, struct image *before)
{
    int last = plan_axis_last_rung(march->axes[axis], &march->scene);

    while (point->rungs[axis] + PLAN_HALVING_RUNGS <= last) {
        struct plan_point finer = *point;
        struct image after = {0};
        double change;

        finer.rungs[axis] += PLAN_HALVING_RUNGS;
        if (!render(march, finer, &after)) return false;
        change = find_change(march->params, before, &after);
        log_debug("plan: axis %d of the march, halved from rung %d on, changes all orders by %.2e", march->axes[axis],
                  point->rungs[axis], change);
        if (!(change > march->params->most)) {
            image_finish(&after);
            return true;
        }
        image_finish(before);
        *before = after;
        *point = finer;
    }
    return true;
}

bool scatter_march_refine(const struct scatter_march_params *params, struct plan *plan, enum renderer_fault *fault,
                          struct error *error)
{
    struct march march = {.params = params, .family = &plan_families[plan->family], .fault = fault, .error = error};
    struct image before = {0};
    bool ok;

    plan_scene_init(&march.scene, params->params->job);
    march.axis_count = plan_family_axes(march.family, &march.scene, march.axes);
    ok = render(&march, plan->point, &before);
    for (int i = 0; i < march.axis_count && ok; i++)
        if (scatter_march_has(march.axes[i])) ok = refine_axis(&march, i, &plan->point, &before);
    image_finish(&before);
    if (ok) plan->quality = plan_family_quality(march.family, &march.scene, &plan->point);
    return ok;
}
