// SPDX-License-Identifier: Apache-2.0
#include "worker/render/frame_layers.h"

#include "core/job/job_layers.h"
#include "worker/picture/image.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

// The share of a frame's progress that the march beside paths gets, and a dome: the other layer takes the time.
static const double SHORT_SHARE = 0.05;

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

// Draws one of a frame's layers into an image with the channels of the layer's job. `first` is the share of progress
// at which it begins.
static bool render_layer(struct renderer *renderer, const struct frame_layers *layers, const struct job *job,
                         struct image *image, double first, struct renderer_result *result, struct error *error)
{
    struct layer_progress progress = {
        .frame = layers->frame, .begin = first, .share = first > 0.0 ? 1.0 - first : SHORT_SHARE};
    struct renderer_frame layer = *layers->frame;
    const struct frame_layers own = {&layer, layers->render};

    layer.job = job;
    layer.image = image;
    layer.on_progress = on_progress;
    layer.on_level = NULL;
    layer.user = &progress;
    // What is seen beside paths may have a dome behind it, too.
    return job_layers_are_two(job) ? layers->render(renderer, &layer, result, error)
                                   : frame_layers_render(renderer, &own, result, error);
}

static void add_costs(struct renderer_result *result, const struct renderer_result *other)
{
    result->seconds += other->seconds;
    result->cache_fills += other->cache_fills;
    result->walks += other->walks;
    result->steps += other->steps;
}

static void swap_doubts(struct image *a, struct image *b)
{
    uint8_t *doubts = a->doubts;

    a->doubts = b->doubts;
    b->doubts = doubts;
}

// Returns the noise of the sum. Interpolated pixels have less than the points around them, as which they count.
static double add(struct image *image, struct image *light)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    double noise = 0.0, power = 0.0;

    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < 3; ++c) {
            image->rgba[4 * i + c] += light->rgba[4 * i + c];
            noise += pow(light->transmittance[4 * i + c], 2.0);
            power += pow(image->rgba[4 * i + c], 2.0);
        }
    swap_doubts(image, light);
    return power > 0.0 ? sqrt(noise / power) : 0.0;
}

// What is seen directly, and scattered light along random paths.
static bool add_scattered(struct renderer *renderer, const struct frame_layers *layers, struct renderer_result *result,
                          struct error *error)
{
    const struct job seen_job = job_layers_seen(layers->frame->job);
    const struct job job = job_layers_scattered(layers->frame->job);
    struct image *image = layers->frame->image, light = {0};
    struct renderer_result seen;
    bool ok = render_layer(renderer, layers, &seen_job, image, 0.0, &seen, error);

    if (!ok) {
        *result = seen;
        return false;
    }
    *result = (struct renderer_result){0};
    ok = image_init(&light, image->width_px, image->height_px, false, true, error) &&
         render_layer(renderer, layers, &job, &light, SHORT_SHARE, result, error);
    if (ok) result->noise = add(image, &light);
    add_costs(result, &seen);
    result->step = seen.step;
    image_finish(&light);
    return ok;
}

// Puts what media show before the dome.
static void cover(struct image *image, struct image *lit)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;

    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < 3; ++c)
            image->rgba[4 * i + c] = lit->rgba[4 * i + c] + lit->transmittance[4 * i + c] * image->rgba[4 * i + c];
    if (image->transmittance) memcpy(image->transmittance, lit->transmittance, 4 * count * sizeof(float));
    if (image->depth) memcpy(image->depth, lit->depth, count * sizeof(float));
    swap_doubts(image, lit);
}

// The dome as if nothing were before it, and what media show of its light and of all other.
static bool add_lit(struct renderer *renderer, const struct frame_layers *layers, struct renderer_result *result,
                    struct error *error)
{
    const struct job sky_job = job_layers_sky(layers->frame->job), job = job_layers_lit(layers->frame->job);
    struct image *image = layers->frame->image, lit = {0}, sky = *image;
    struct renderer_result behind;
    bool ok;

    // A dome has neither of these.
    sky.transmittance = sky.depth = NULL;
    ok = render_layer(renderer, layers, &sky_job, &sky, 0.0, &behind, error);
    image->doubts = sky.doubts;
    if (!ok) {
        *result = behind;
        return false;
    }
    *result = (struct renderer_result){0};
    ok = image_init(&lit, image->width_px, image->height_px, image->depth != NULL, true, error) &&
         render_layer(renderer, layers, &job, &lit, SHORT_SHARE, result, error);
    if (ok) cover(image, &lit);
    add_costs(result, &behind);
    image_finish(&lit);
    return ok;
}

bool frame_layers_render(struct renderer *renderer, const struct frame_layers *layers, struct renderer_result *result,
                         struct error *error)
{
    const struct job *job = layers->frame->job;

    if (job_layers_are_two(job)) return add_scattered(renderer, layers, result, error);
    return job_layers_have_sky(job) ? add_lit(renderer, layers, result, error)
                                    : layers->render(renderer, layers->frame, result, error);
}
