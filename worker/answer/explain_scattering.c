// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/explain_scattering.h"

#include "core/job/job.h"
#include "core/job/job_beyond.h"

#include <stdio.h>

bool explain_scattering(const struct job *job, const struct job_beyond *beyond,
                        char why[static EXPLAIN_SCATTERING_SIZE])
{
    const struct job_quality *quality = &job->quality;
    int orders = job->scene.orders;
    char count[64] = "any number of times, by all orders", paths[96] = "", left[JOB_BEYOND_TEXT_SIZE];

    job_beyond_describe(beyond, orders, left);
    if (orders <= 1) {
        snprintf(why, EXPLAIN_SCATTERING_SIZE, "light is scattered once at most%s%s", left[0] ? "; " : "", left);
        return false;
    }
    if (orders != SCENE_ORDERS_ALL) snprintf(count, sizeof count, "up to %d times", orders);
    if (quality->method == JOB_METHOD_PATHS)
        snprintf(paths, sizeof paths, ", along %d random paths a pixel", quality->paths);
    else if (quality->scatter_grid > 0)
        snprintf(paths, sizeof paths, "; beyond once by a grid of %d cells, %d random paths a node",
                 quality->scatter_grid, quality->paths);
    snprintf(why, EXPLAIN_SCATTERING_SIZE, "light is scattered %s%s%s%s", count, paths, left[0] ? "; " : "", left);
    return true;
}
