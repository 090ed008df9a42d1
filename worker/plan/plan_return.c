// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_return.h"

#include "worker/picture/audit_result.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_lookup.h"

#include <stdio.h>

// Set by hand: nearer to the tolerance, one of the next frames would soon miss again.
static const double AT_EASE = 0.8;

bool plan_return_find(const struct plan *plan, const struct job *job, int32_t frame, struct plan *before)
{
    struct plan_scene scene;

    if (!plan->has_before || scene_is_constant(&job->scene) ||
        frame_range_index(&job->frames, frame) % PLAN_RETURN_PACE != 0)
        return false;
    plan_scene_init(&scene, job);
    *before = (struct plan){.quality = plan->before, .pixels = plan->before.pixels};
    before->quality.pixels = (struct job_pixels){0};
    if (!plan_lookup(&scene, &plan->before, &before->family, &before->point)) return false;
    snprintf(before->reason, sizeof before->reason, "%s, as before a frame that missed",
             plan_families[before->family].name);
    return true;
}

bool plan_return_holds(const struct audit_result *audit)
{
    return audit->error + audit->spread <= AT_EASE * audit->tolerance;
}

void plan_return_note(struct plan *found, const struct plan *missed)
{
    found->has_before = true;
    found->before = missed->has_before ? missed->before : missed->quality;
    if (!missed->has_before) found->before.pixels = missed->pixels;
}
