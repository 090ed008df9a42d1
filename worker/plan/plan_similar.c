// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_similar.h"

#include "core/job/job.h"

static const double SHARP = 0.3; // g of a lobe
static const double TOLERANCE_LEAST = 0.01;
enum { AFTER = 1 }; // scatterings: what more save of error is not seen

int plan_similar_after(const struct job *job)
{
    double time = job_frame_time(job, frame_range_at(&job->frames, 0));
    bool is_sharp = false;

    for (size_t i = 0; i < job->scene.medium_count; i++)
        for (size_t k = 0; k < job->scene.media[i].lobe_count; k++) {
            const struct scene_phase_lobe *lobe = &job->scene.media[i].lobes[k];
            double g[3] = {0};

            if (lobe->kind == SCENE_LOBE_HENYEY_GREENSTEIN) timeline_evaluate(&lobe->g, time, g);
            is_sharp |= g[0] >= SHARP;
        }
    if (!is_sharp || job->scene.orders != SCENE_ORDERS_ALL || job->quality.tolerance < TOLERANCE_LEAST ||
        job->scene.medium_count > JOB_CACHED_MEDIUM_LIMIT)
        return 0;
    return AFTER;
}
