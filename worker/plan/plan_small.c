// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_small.h"

#include "worker/picture/image.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer.h"

#include <math.h>

double plan_small_scale(const struct job *job, int pixel_limit)
{
    return fmin(1.0, sqrt(pixel_limit / ((double)job->width_px * job->height_px)));
}

struct job plan_small_job(const struct job *job, double scale)
{
    struct job small = *job;

    small.width_px = (int)fmax(1.0, round(scale * job->width_px));
    small.height_px = (int)fmax(1.0, round(scale * job->height_px));
    small.quality.pixels = (struct job_pixels){0};
    return small;
}

static bool tell(const struct plan_params *params, double rendered)
{
    double done = params->tells_renders ? rendered : 0.0;

    return !params->on_progress || params->on_progress(params->user, params->done ? *params->done : done);
}

bool plan_small_on_pixel(void *user)
{
    return tell(user, 0.0);
}

bool plan_small_on_tile(void *user, double done)
{
    return tell(user, done);
}

bool plan_small_render(const struct plan_params *params, const struct job *job, int32_t frame, struct image *image,
                       struct renderer_result *result, struct error *error)
{
    if (!image_fits(image, job->width_px, job->height_px, job->output.has_depth, job->output.has_transmittance)) {
        *result = (struct renderer_result){.fault = RENDERER_FAULT_FRAME};
        image_finish(image);
        if (!image_init_for_job(image, job, error)) return false;
    }
    return renderer_render(
        params->renderer,
        &(struct renderer_frame){
            .job = job, .frame = frame, .image = image, .on_progress = plan_small_on_tile, .user = (void *)params},
        result, error);
}
