// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/scene_reach.h"

#include "core/job/job.h"
#include "worker/scene/pixel_samples.h"
#include "worker/scene/scene_inputs.h"
#include "worker/scene/scene_sight.h"

#include <math.h>

// So that no rounding takes anything off a medium's edge.
static const double MARGIN = 1e-4;

static void add_moment(struct scene_reach *reach, const struct job *job, const struct scene_inputs *inputs, double time)
{
    double camera[3];

    timeline_evaluate(&job->scene.camera.position, time, camera);
    for (size_t i = 0; i < job->scene.medium_count; ++i) {
        struct scene_ball ball = scene_sight_ball(job, inputs, i, time);
        double distance =
            hypot(hypot(ball.center[0] - camera[0], ball.center[1] - camera[1]), ball.center[2] - camera[2]);

        reach->near = fmin(reach->near, distance - (1 + MARGIN) * ball.radius);
        reach->far = fmax(reach->far, distance + (1 + MARGIN) * ball.radius);
        reach->length = fmin(reach->length, 2 * ball.radius);
    }
}

struct scene_reach scene_reach_find(const struct job *job, const struct scene_inputs *inputs, int32_t frame)
{
    const struct scene_camera *camera = &job->scene.camera;
    struct scene_reach reach = {.near = INFINITY, .length = INFINITY};
    double voxel = scene_inputs_find_voxel(inputs);
    int samples = pixel_samples_count(job);

    for (int i = 0; i < samples; ++i)
        add_moment(&reach, job, inputs, pixel_samples_time(job, frame, i));
    reach.near = fmax(reach.near, camera->clip_near);
    reach.far = fmin(reach.far, camera->clip_far);
    if (!(reach.near < reach.far)) { // no medium, or none within the clip distances
        reach.near = camera->clip_near;
        reach.far = camera->clip_far;
    }
    reach.length = fmin(reach.length, reach.far - reach.near);
    if (!isfinite(reach.length)) reach.length = 1;
    reach.voxel = isfinite(voxel) ? voxel : 0;
    return reach;
}
