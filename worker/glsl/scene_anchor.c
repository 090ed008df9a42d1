// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/scene_anchor.h"

#include "core/job/job.h"

#include <math.h>

// m; floats up to half of it are 3e-5 m apart
static const double STEP = 1024;

bool scene_anchor_is_used(const struct job *job)
{
    double least[3], most[3];

    timeline_find_bounds(&job->scene.camera.position, job_time_span(job), least, most);
    for (int i = 0; i < 3; ++i)
        if (!(fabs(least[i]) < 0.5 * STEP && fabs(most[i]) < 0.5 * STEP)) return true;
    return false;
}

bool scene_anchor_moves(const struct job *job)
{
    return !timeline_is_constant(&job->scene.camera.position) && scene_anchor_is_used(job);
}

void scene_anchor_find(const struct job *job, double time, double anchor[static 3])
{
    double position[9] = {0};
    bool is_used = scene_anchor_is_used(job);

    if (is_used) timeline_evaluate(&job->scene.camera.position, time, position);
    for (int i = 0; i < 3; ++i)
        anchor[i] = is_used ? STEP * round(position[i] / STEP) : 0;
}
