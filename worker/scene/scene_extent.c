// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/scene_extent.h"

#include "core/job/job.h"
#include "worker/scene/media_extent.h"
#include "worker/scene/pixel_samples.h"
#include "worker/scene/scene_inputs.h"

#include <math.h>

// The margin keeps rounding from cutting off a medium's edge.
static const double MARGIN = 1e-4;

static void add_moment(struct scene_extent *extent, const struct job *job, const struct scene_inputs *inputs,
                       double time)
{
    double camera[3];

    timeline_evaluate(&job->scene.camera.position, time, camera);
    for (size_t i = 0; i < job->scene.medium_count; ++i) {
        struct scene_ball ball = media_extent_ball(job, inputs, i, time);
        double distance =
            hypot(hypot(ball.center[0] - camera[0], ball.center[1] - camera[1]), ball.center[2] - camera[2]);

        extent->near = fmin(extent->near, distance - (1 + MARGIN) * ball.radius);
        extent->far = fmax(extent->far, distance + (1 + MARGIN) * ball.radius);
        extent->length = fmin(extent->length, 2 * ball.radius);
    }
}

struct scene_extent scene_extent_find(const struct job *job, const struct scene_inputs *inputs, int32_t frame)
{
    const struct scene_camera *camera = &job->scene.camera;
    struct scene_extent extent = {.near = INFINITY, .length = INFINITY};
    double voxel = scene_inputs_find_voxel(inputs);
    int samples = pixel_samples_count(job);

    for (int i = 0; i < samples; ++i)
        add_moment(&extent, job, inputs, pixel_samples_time(job, frame, i));
    extent.near = fmax(extent.near, camera->clip_near);
    extent.far = fmin(extent.far, camera->clip_far);
    if (!(extent.near < extent.far)) { // no medium, or none within the clip distances
        extent.near = camera->clip_near;
        extent.far = camera->clip_far;
    }
    extent.length = fmin(extent.length, extent.far - extent.near);
    if (!isfinite(extent.length)) extent.length = 1;
    extent.voxel = isfinite(voxel) ? voxel : 0;
    return extent;
}
