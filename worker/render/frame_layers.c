// SPDX-License-Identifier: Apache-2.0
#include "worker/render/frame_layers.h"

#include "core/job/job_layers.h"
#include "worker/picture/image.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

// The share of a frame's progress that the march gets: paths take the time.
static const double SEEN_SHARE = 0.05;

struct layer_progress {
    const struct renderer_frame *frame; // borrowed
    double begin, share;
};

static bool on_progress(void *user, double done)
{
    const struct layer_progress *progress = user;
    const struct renderer_frame *frame = progress->frame;

    return !frame->on_progress || frame->on_progress(frame->user, progress->begin + done * progress->share);
}

static bool render_seen(struct renderer *renderer, frame_layers_render *render, const struct renderer_frame *frame,
                        struct renderer_result *result, struct error *error)
{
    const struct job job = job_layers_seen(frame->job);
    struct layer_progress progress = {.frame = frame, .share = SEEN_SHARE};
    struct renderer_frame layer = *frame;

    layer.job = &job;
    layer.on_progress = on_progress;
    layer.on_level = NULL;
    layer.user = &progress;
    return render(renderer, &layer, result, error);
}

static bool render_scattered(struct renderer *renderer, frame_layers_render *render, const struct renderer_frame *frame,
                             struct image *light, struct renderer_result *result, struct error *error)
{
    const struct job job = job_layers_scattered(frame->job);
    struct layer_progress progress = {.frame = frame, .begin = SEEN_SHARE, .share = 1.0 - SEEN_SHARE};
    struct renderer_frame layer = *frame;

    layer.job = &job;
    layer.image = light;
    layer.on_progress = on_progress;
    layer.on_level = NULL;
    layer.user = &progress;
    return image_init(light, frame->image->width_px, frame->image->height_px, false, true, error) &&
           render(renderer, &layer, result, error);
}

// Returns the noise of the sum. Interpolated pixels have less than the points around them, as which they count.
static double add(struct image *image, struct image *light)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    uint8_t *doubts = light->doubts;
    double noise = 0.0, power = 0.0;

    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < 3; ++c) {
            image->rgba[4 * i + c] += light->rgba[4 * i + c];
            noise += pow(light->transmittance[4 * i + c], 2.0);
            power += pow(image->rgba[4 * i + c], 2.0);
        }
    light->doubts = image->doubts;
    image->doubts = doubts;
    return power > 0.0 ? sqrt(noise / power) : 0.0;
}

bool frame_layers_add(struct renderer *renderer, frame_layers_render *render, const struct renderer_frame *frame,
                      struct renderer_result *result, struct error *error)
{
    struct renderer_result seen;
    struct image light = {0};
    bool ok = render_seen(renderer, render, frame, &seen, error);

    if (!ok) {
        *result = seen;
        return false;
    }
    ok = render_scattered(renderer, render, frame, &light, result, error);
    if (ok) result->noise = add(frame->image, &light);
    result->seconds += seen.seconds;
    result->cache_fills += seen.cache_fills;
    result->walks += seen.walks;
    result->steps += seen.steps;
    result->step = seen.step;
    image_finish(&light);
    return ok;
}
