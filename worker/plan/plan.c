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

        rung = rung < 0 ? 0 : rung > last ? last : rung;
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

double plan_frame_weight(const struct plan *plan, const struct job *job, const struct plan_segment *segment,
                         int32_t frame)
{
    static const float CLEAR = 0.0f;
    struct plan_scene scene;
    double own = 0.0, sum = 0.0;

    // Rays that nothing ends: only ratios count here.
    plan_scene_init(&scene, job);
    scene.depths = &CLEAR;
    scene.depth_count = 1;
    scene.hit_share = 1.0;
    for (int64_t i = 0; i < segment->count; i++) {
        int32_t number = frame_range_at(&job->frames, segment->first + i);
        struct plan of_frame = plan_of_frame(plan, job, number);
        double work = plan_family_work(&scene, &of_frame.quality);

        sum += work;
        if (number == frame) own = work;
    }
    return own * (double)segment->count / sum;
}

struct job plan_apply(const struct plan *plan, const struct job *job)
{
    struct job planned = *job;

    planned.quality = plan->quality;
    planned.quality.pixels = plan->pixels;
    if (planned.quality.method == JOB_METHOD_PATHS) {
        struct plan_scene scene;

        plan_scene_init(&scene, job);
        plan_family_add_seen(&scene, &planned.quality);
    }
    return planned;
}
