// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_layers.h"

bool job_layers_are_two(const struct job *job)
{
    const struct job_quality *quality = &job->quality;
    bool is_even = true;

    for (size_t i = 0; i < job->scene.medium_count; i++)
        is_even = is_even && scene_density_is_even(&job->scene.media[i].density);
    return quality->method == JOB_METHOD_PATHS &&
           (is_even || quality->step > 0.0 || quality->step_voxels > 0.0 || quality->pixels.stride > 0);
}

struct job job_layers_seen(const struct job *job)
{
    struct job seen = *job;

    seen.scene.orders = 1;
    seen.scene.light_count = 0;
    for (size_t i = 0; i < job->scene.light_count; i++)
        if (job->scene.lights[i].kind == SCENE_LIGHT_DOME && job->scene.lights[i].dome.is_visible)
            seen.scene.lights[seen.scene.light_count++] = job->scene.lights[i];
    seen.quality.method = JOB_METHOD_MIDPOINT;
    seen.quality.paths = seen.quality.light_grid = 0;
    return seen;
}

struct job job_layers_scattered(const struct job *job)
{
    struct job scattered = *job;

    scattered.output.has_depth = false;
    scattered.output.has_transmittance = true;
    return scattered;
}
