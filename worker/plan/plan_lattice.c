// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_lattice.h"

#include "core/base/alloc.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_small.h"

#include <stdlib.h>

static int middle_of(int block, int count, int size_px)
{
    return (int)((2 * (int64_t)block + 1) * size_px / (2 * (int64_t)count));
}

void plan_lattice_init(struct plan_lattice *lattice, const struct job *job, int pixel_limit)
{
    struct job small = plan_small_job(job, plan_small_scale(job, pixel_limit));

    plan_lattice_init_sized(lattice, job, small.width_px, small.height_px);
}

void plan_lattice_init_sized(struct plan_lattice *lattice, const struct job *job, int columns, int rows)
{
    *lattice = (struct plan_lattice){.columns = columns, .rows = rows};
    lattice->pixels = xcalloc(plan_lattice_count(lattice), sizeof *lattice->pixels);
    for (int row = 0; row < lattice->rows; row++)
        for (int column = 0; column < lattice->columns; column++)
            lattice->pixels[(size_t)row * (size_t)lattice->columns + (size_t)column] = (struct pixel){
                middle_of(column, lattice->columns, job->width_px), middle_of(row, lattice->rows, job->height_px)};
}

static double brightness_at(const struct image *frame, struct pixel at)
{
    const float *value = &frame->rgba[4 * ((size_t)at.y * (size_t)frame->width_px + (size_t)at.x)];

    return (double)value[0] + value[1] + value[2];
}

void plan_lattice_seek_light(struct plan_lattice *lattice, const struct image *frame)
{
    for (int y = 0; y < frame->height_px; y++)
        for (int x = 0; x < frame->width_px; x++) {
            int column = (int)((int64_t)x * lattice->columns / frame->width_px);
            int row = (int)((int64_t)y * lattice->rows / frame->height_px);
            struct pixel *shown = &lattice->pixels[(size_t)row * (size_t)lattice->columns + (size_t)column];

            if (brightness_at(frame, (struct pixel){x, y}) > brightness_at(frame, *shown))
                *shown = (struct pixel){x, y};
        }
}

void plan_lattice_finish(struct plan_lattice *lattice)
{
    free(lattice->pixels);
    *lattice = (struct plan_lattice){0};
}

size_t plan_lattice_count(const struct plan_lattice *lattice)
{
    return (size_t)lattice->columns * (size_t)lattice->rows;
}

struct list {
    const struct pixel *pixels;
    int columns, rows;
    enum renderer_stream stream;
};

static bool render(const struct list *list, const struct plan_params *params, const struct job *job, int32_t frame,
                   struct image *image, struct renderer_result *result, struct error *error)
{
    bool has_depth = job->output.has_depth, has_transmittance = job->output.has_transmittance;

    if (!image_fits(image, list->columns, list->rows, has_depth, has_transmittance)) {
        *result = (struct renderer_result){.fault = RENDERER_FAULT_FRAME};
        image_finish(image);
        if (!image_init(image, list->columns, list->rows, has_depth, has_transmittance, error)) return false;
    }
    return renderer_render(params->renderer,
                           &(struct renderer_frame){.job = job,
                                                    .frame = frame,
                                                    .stream = list->stream,
                                                    .pixels = list->pixels,
                                                    .pixel_count = (size_t)list->columns * (size_t)list->rows,
                                                    .image = image,
                                                    .on_progress = plan_small_on_tile,
                                                    .user = (void *)params},
                           result, error);
}

bool plan_list_render(const struct plan_params *params, const struct job *job, int32_t frame,
                      const struct pixel *pixels, int columns, int rows, struct image *image,
                      struct renderer_result *result, struct error *error)
{
    return render(&(struct list){pixels, columns, rows, RENDERER_STREAM_PICTURE}, params, job, frame, image, result,
                  error);
}

static bool render_single(const struct plan_lattice *lattice, enum renderer_stream stream,
                          const struct plan_params *params, const struct job *job, int32_t frame, struct image *image,
                          struct renderer_result *result, struct error *error)
{
    const struct list list = {lattice->pixels, lattice->columns, lattice->rows, stream};
    struct job single = *job;

    single.quality.samples = 1;
    return render(&list, params, &single, frame, image, result, error);
}

bool plan_lattice_render(const struct plan_lattice *lattice, const struct plan_params *params, const struct job *job,
                         int32_t frame, struct image *image, struct renderer_result *result, struct error *error)
{
    return render_single(lattice, RENDERER_STREAM_PLAN, params, job, frame, image, result, error);
}

bool plan_lattice_render_again(const struct plan_lattice *lattice, const struct plan_params *params,
                               const struct job *job, int32_t frame, struct image *image,
                               struct renderer_result *result, struct error *error)
{
    return render_single(lattice, RENDERER_STREAM_PLAN_AGAIN, params, job, frame, image, result, error);
}

void plan_lattice_find(const struct plan_lattice *lattice, const struct pixel *points, size_t count,
                       struct pixel *pixels)
{
    for (size_t i = 0; i < count; i++)
        pixels[i] = lattice->pixels[(size_t)points[i].y * (size_t)lattice->columns + (size_t)points[i].x];
}
