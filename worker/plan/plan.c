// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan.h"

#include "worker/plan/plan_family.h"

bool plan_refine(struct plan *plan, const struct job *job, int rungs)
{
    const struct plan_family *family = &plan_families[plan->family];
    struct plan_scene scene;
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    bool moved = false;
    int count;

    plan_scene_init(&scene, job);
    count = plan_family_axes(family, &scene, axes);
    for (int i = 0; i < count; i++) {
        int last = plan_axis_last_rung(axes[i], &scene), rung = plan->point.rungs[i] + rungs;

        if (rung > last) rung = last;
        moved |= rung != plan->point.rungs[i];
        plan->point.rungs[i] = rung;
    }
    plan->quality = plan_family_quality(family, &scene, &plan->point);
    return moved;
}

struct plan plan_of_frame(const struct plan *plan, const struct job *job, int32_t frame)
{
    int64_t index = frame_range_index(&job->frames, frame);
    int rungs = plan_scouting_find_rungs(&plan->scouting, index, job->quality.tolerance);
    struct plan of_frame = *plan;

    if (rungs > 0) (void)plan_refine(&of_frame, job, rungs);
    return of_frame;
}

struct job plan_apply(const struct plan *plan, const struct job *job)
{
    struct job planned = *job;

    planned.quality = plan->quality;
    return planned;
}
