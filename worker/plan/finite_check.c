// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/finite_check.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/glsl/glsl_guard.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <stdlib.h>

// Of a frame that is looked at: few beside all that are rendered.
enum { PIXELS_MIN = 16, PIXELS_MAX = 256, PIXELS_PART = 100 };

bool finite_check_find(const struct image *image, size_t *index)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;

    for (*index = 0; *index < count; ++*index) {
        const float *colour = &image->rgba[4 * *index];

        if (!isfinite(colour[0] + colour[1] + colour[2])) return true;
    }
    return false;
}

// One pixel of a frame, rendered with the user's code changed.
struct trial {
    struct renderer *renderer;
    struct job job; // a shallow copy, with one sample
    int32_t frame;
    struct pixel pixel;
};

// Renders the pixel. False also where that fails: a guarded assignment may have no guard for its type.
static bool is_finite(const struct trial *trial)
{
    struct renderer_result result;
    struct image image = {0};
    struct error unwanted = {{0}};
    size_t index;
    bool ok =
        image_init(&image, 1, 1, trial->job.output.has_depth, trial->job.output.has_transmittance, &unwanted) &&
        renderer_render(
            trial->renderer,
            &(struct renderer_frame){
                .job = &trial->job, .frame = trial->frame, .pixels = &trial->pixel, .pixel_count = 1, .image = &image},
            &result, &unwanted) &&
        !finite_check_find(&image, &index);

    image_finish(&image);
    return ok;
}

static bool is_finite_with(struct trial *trial, struct scene_glsl *code, int guarded, bool is_returns_only, int *line)
{
    char *source = code->source;
    struct glsl_guarded text = glsl_guard(source, guarded, is_returns_only);
    bool ok = false;

    if (text.text) {
        code->source = text.text;
        ok = is_finite(trial);
        code->source = source;
    }
    *line = text.line;
    free(text.text);
    return ok;
}

// Searches by halving: what follows a statement that is guarded matters no more. 0: no guard helps.
static int find_line(struct trial *trial, struct scene_glsl *code, bool is_returns_only)
{
    struct glsl_guarded all = glsl_guard(code->source, 0, is_returns_only);
    int low = 1, high = all.count, line = 0;

    free(all.text);
    if (high == 0 || !is_finite_with(trial, code, high, is_returns_only, &line)) return 0;
    while (low < high) {
        int middle = low + (high - low) / 2;

        if (is_finite_with(trial, code, middle, is_returns_only, &line))
            high = middle;
        else
            low = middle + 1;
    }
    (void)is_finite_with(trial, code, high, is_returns_only, &line);
    return line;
}

void finite_check_tell(struct renderer *renderer, const struct job *job, int32_t frame, struct pixel pixel,
                       struct error *error)
{
    struct trial trial = {.renderer = renderer, .job = *job, .frame = frame, .pixel = pixel};

    // One sample of many may meet none of it.
    trial.job.quality.samples = 1;
    if (is_finite(&trial)) trial.job.quality.samples = job->quality.samples;
    for (size_t i = 0; i < trial.job.scene.medium_count; i++) {
        struct scene_density *density = &trial.job.scene.media[i].density;
        int line;

        if (density->kind != SCENE_DENSITY_GLSL || !density->glsl.source) continue;
        line = find_line(&trial, &density->glsl, false);
        if (line == 0) line = find_line(&trial, &density->glsl, true);
        if (line == 0) continue;
        error_set(
            error,
            "scene.media[%zu].density: %s:%d gives a value that is not finite (frame %d, pixel (%d, %d)); expected "
            "no division by 0, no root or logarithm of negative numbers",
            i, scene_glsl_name(&density->glsl), line, frame, pixel.x, pixel.y);
        return;
    }
    error_set(error,
              "frame %d, pixel (%d, %d): its light is not finite; expected densities, numbers and files without NaN "
              "and infinity",
              frame, pixel.x, pixel.y);
}

bool finite_check_frame(const struct plan_params *params, int32_t frame, enum renderer_fault *fault,
                        struct error *error)
{
    const struct job *job = params->job;
    struct job single = *job;
    int64_t part = (int64_t)job->width_px * job->height_px / PIXELS_PART;
    struct renderer_result result;
    struct plan_lattice lattice;
    struct image image = {0};
    struct error unwanted = {{0}};
    size_t index;
    bool ok, is_stopped;

    plan_lattice_init(&lattice, job, part < PIXELS_MIN ? PIXELS_MIN : part > PIXELS_MAX ? PIXELS_MAX : (int)part);
    single.quality.samples = 1;
    // With the picture's random numbers, so that it finds the caches that this fills.
    ok = plan_list_render(params, &single, frame, lattice.pixels, lattice.columns, lattice.rows, &image, &result,
                          &unwanted);
    // Other faults are told by the frame itself, by its own rules.
    is_stopped = !ok && renderer_fault_is_final(result.fault);
    *fault = ok || is_stopped ? result.fault : RENDERER_FAULT_NONE;
    if (is_stopped && error) *error = unwanted;
    if (ok && finite_check_find(&image, &index)) {
        finite_check_tell(params->renderer, job, frame, lattice.pixels[index], error);
        *fault = RENDERER_FAULT_FRAME;
    }
    image_finish(&image);
    plan_lattice_finish(&lattice);
    return *fault == RENDERER_FAULT_NONE;
}

bool finite_check_picture(struct renderer *renderer, const struct job *job, int32_t frame, const struct image *image,
                          struct error *error)
{
    int width_px = image->width_px;
    size_t index;

    if (image_is_finite(image, job->output.pixel == JOB_PIXEL_HALF, error)) return true;
    if (!finite_check_find(image, &index)) return false;
    finite_check_tell(renderer, job, frame,
                      (struct pixel){(int)(index % (size_t)width_px), (int)(index / (size_t)width_px)}, error);
    return false;
}
