// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_similar.h"

#include "core/job/job.h"

#include <math.h>

static const double SHARP = 0.3; // g of a lobe
static const double TOLERANCE_LEAST = 0.01;
// The mean cosine of all turns of light that was scattered so often: what is left of where it came from.
static const double REMEMBERED = 0.63;

int plan_similar_after(const struct job *job)
{
    double time = job_frame_time(job, frame_range_at(&job->frames, 0));
    double sharpest = 0.0;

    for (size_t i = 0; i < job->scene.medium_count; i++)
        for (size_t k = 0; k < job->scene.media[i].lobe_count; k++) {
            const struct scene_phase_lobe *lobe = &job->scene.media[i].lobes[k];
            double g[3] = {0};

            if (lobe->kind == SCENE_LOBE_HENYEY_GREENSTEIN) timeline_evaluate(&lobe->g, time, g);
            sharpest = fmax(sharpest, g[0]);
        }
    if (sharpest < SHARP || job->scene.orders != SCENE_ORDERS_ALL || job->quality.tolerance < TOLERANCE_LEAST ||
        job->scene.medium_count > JOB_CACHED_MEDIUM_LIMIT)
        return 0;
    return (int)fmin(fmax(ceil(log(REMEMBERED) / log(sharpest)) - 1.0, 1.0), JOB_SIMILAR_LIMIT);
}
