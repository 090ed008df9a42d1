// Time against error of a job whose rays are reflected and refracted: paths_bench JOB.
// SPDX-License-Identifier: Apache-2.0
// Each setting is timed at the job's resolution with one sample a pixel, and compared with reference/ along the same
// rays in pixels spread over the picture.
#include "cli/job/job_document.h"
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/reference.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/scene/texture_image.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 54, COLUMNS = 96, RUNS = 3, FRAME = 48 };

// The truth follows rays much further than every setting here.
static const int TRUE_DEPTH = 24;
static const double TRUE_THROUGHPUT = 1e-7;

static const struct {
    int max_depth;
    double min_throughput;
} settings[] = {{1, 1e-3}, {2, 1e-3}, {3, 1e-3}, {4, 1e-3}, {8, 3e-1},
                {8, 1e-1}, {8, 1e-2}, {8, 1e-3}, {8, 1e-4}, {16, 1e-5}};

static bool load_textures(struct still_inputs *inputs, const struct job *job, struct error *error)
{
    for (size_t i = 0; i < job->scene.object_count; i++) {
        const struct scene_texture *source = &job->scene.objects[i].material.texture;
        struct image image;
        float *rgb;
        size_t count;

        if (!source->file) continue;
        if (!texture_image_load(&image, source, error)) return false;
        count = (size_t)image.width_px * (size_t)image.height_px;
        rgb = xcalloc(3 * count, sizeof *rgb);
        for (size_t k = 0; k < 3 * count; k++)
            rgb[k] = image.rgba[k / 3 * 4 + k % 3];
        inputs->textures[i] = (struct still_texture){rgb, image.width_px, image.height_px};
        image_finish(&image);
    }
    return true;
}

// Finds the position of the compared pixel `i`.
static void find_place(const struct job *job, int i, int *x, int *y)
{
    *x = (2 * (i % COLUMNS) + 1) * job->width_px / (2 * COLUMNS);
    *y = (2 * (i / COLUMNS) + 1) * job->height_px / (2 * ROWS);
}

static bool measure_truth(const struct job *job, double *truth, struct error *error)
{
    struct still_inputs *inputs = xcalloc(1, sizeof *inputs);
    struct still *still = xcalloc(1, sizeof *still);
    bool ok = load_textures(inputs, job, error);

    if (ok) still_init_with_inputs(still, job, job_frame_time(job, FRAME), inputs);
    for (int i = 0; ok && i < ROWS * COLUMNS; i++) {
        struct reference_pixel pixel;
        int x, y;

        find_place(job, i, &x, &y);
        pixel = reference_measure_pixel(still, x, y, NULL);
        memcpy(truth + 3 * (size_t)i, pixel.radiance, sizeof pixel.radiance);
    }
    for (size_t i = 0; i < SCENE_OBJECT_LIMIT; i++)
        free((void *)(uintptr_t)inputs->textures[i].rgb);
    free(still);
    free(inputs);
    return ok;
}

static struct reference_error find_error(const struct job *job, const struct image *image, const double *truth)
{
    float *seen = xcalloc((size_t)3 * ROWS * COLUMNS, sizeof *seen);
    struct reference_error error;

    for (int i = 0; i < ROWS * COLUMNS; i++) {
        int x, y;

        find_place(job, i, &x, &y);
        memcpy(seen + 3 * (size_t)i, image->rgba + 4 * ((size_t)y * (size_t)image->width_px + (size_t)x),
               3 * sizeof *seen);
    }
    error = reference_image_error(seen, truth, (size_t)3 * ROWS * COLUMNS);
    free(seen);
    return error;
}

static int compare(const void *a, const void *b)
{
    const double *left = a, *right = b;

    return (*left > *right) - (*left < *right);
}

// Renders different frames, so that none is a copy; the last one is the truth's.
static bool render(struct gl_context *context, const struct job *job, struct image *image, double *median,
                   struct ray_counts *counts, struct error *error)
{
    struct renderer *renderer = renderer_create(context, NULL);
    struct renderer_result result;
    double seconds[RUNS + 1];
    bool ok = true;

    for (int i = 0; ok && i <= RUNS; i++) { // the first one compiles
        double start = clock_now_s();

        ok = renderer_render(renderer, &(struct renderer_frame){.job = job, .frame = FRAME - RUNS + i, .image = image},
                             &result, error);
        seconds[i] = clock_now_s() - start;
    }
    if (ok) *counts = result.ray_counts;
    renderer_destroy(renderer);
    qsort(seconds + 1, RUNS, sizeof *seconds, compare);
    *median = seconds[1 + RUNS / 2];
    return ok;
}

static bool measure(struct gl_context *context, struct job *job, const double *truth, struct error *error)
{
    struct image image = {0};
    bool ok = image_init(&image, job->width_px, job->height_px, false, false, error);

    printf("%9s %14s %9s %12s %10s %12s %14s %14s\n", "max_depth", "min_throughput", "s", "rays a pixel", "most",
           "cut share", "relative RMSE", "largest error");
    for (size_t i = 0; ok && i < sizeof settings / sizeof *settings; i++) {
        struct ray_counts counts;
        double seconds;

        job->quality.max_depth = settings[i].max_depth;
        job->quality.min_throughput = settings[i].min_throughput;
        ok = render(context, job, &image, &seconds, &counts, error);
        if (ok) {
            struct reference_error found = find_error(job, &image, truth);

            printf("%9d %14.0e %9.3f %12.2f %10.0f %12.1e %14.1e %14.1e\n", settings[i].max_depth,
                   settings[i].min_throughput, seconds, counts.rays, counts.most_rays.value, counts.cut_share,
                   found.relative_rmse, found.largest);
            fflush(stdout);
        }
    }
    image_finish(&image);
    return ok;
}

int main(int argc, char *argv[])
{
    struct error error = {0};
    struct job job = {0};
    struct gl_context *context = NULL;
    char *document = argc == 2 ? job_document_load(argv[1], NULL, 0, &error) : NULL;
    double *truth = xcalloc((size_t)3 * ROWS * COLUMNS, sizeof *truth);
    bool ok = document && job_document_check(argv[1], document, "/", &job, &error);

    if (ok) {
        context = gl_context_create(GL_BACKEND_SOFTWARE, NULL, &error);
        job.quality = (struct job_quality){.method = JOB_METHOD_EQUIANGULAR, .points = 1, .samples = 1, .max_cut = 1.0};
        job.quality.max_depth = TRUE_DEPTH;
        job.quality.min_throughput = TRUE_THROUGHPUT;
        job.output.has_depth = job.output.has_transmittance = false;
    }
    ok = context && measure_truth(&job, truth, &error) && measure(context, &job, truth, &error);
    if (!ok) printf("%s\n", argc == 2 ? error.message : "usage: paths_bench JOB");
    if (context) gl_context_destroy(context);
    job_finish(&job);
    free(document);
    free(truth);
    return !ok;
}
