// The processor time of lists of pixels, a pixel, over that of the whole frame: pixel_list_bench JOB...
// SPDX-License-Identifier: Apache-2.0
// Frames are 640 pixels wide, with one sample; a job without a method is drawn as its draft. Lists are drawn at random
// from the frame. Medians of five; on a GPU the times are wall time. Before them stands what linking takes: the first
// list of 64 pixels without the second, so with reading the job's files.
#include "cli/job/job_document.h"
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/picture/pixel.h"
#include "worker/plan/draft.h"
#include "worker/render/renderer.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { WIDTH = 640, REPEATS = 5, SIDE = 64 };

static const size_t counts[] = {64, 256, 1024, 4096, 16384, 65536};

enum { LIST_COUNT = sizeof counts / sizeof *counts };

struct bench {
    struct renderer *renderer;
    struct job job;
    clockid_t clock;
};

static double time_once(struct bench *bench, const struct pixel *pixels, size_t count)
{
    struct error error = {{0}};
    struct renderer_result result;
    struct image image = {0};
    double start, seconds;
    bool ok = pixels ? image_init(&image, SIDE, (int)(count / SIDE), bench->job.output.has_depth,
                                  bench->job.output.has_transmittance, &error)
                     : image_init_for_job(&image, &bench->job, &error);

    if (!pixels) renderer_forget(bench->renderer); // else the frame would be copied
    start = clock_read_s(bench->clock);
    ok = ok && renderer_render(bench->renderer,
                               &(struct renderer_frame){.job = &bench->job,
                                                        .frame = frame_range_at(&bench->job.frames, 0),
                                                        .pixels = pixels,
                                                        .pixel_count = count,
                                                        .image = &image},
                               &result, &error);
    seconds = clock_read_s(bench->clock) - start;
    image_finish(&image);
    if (ok) return seconds;
    fprintf(stderr, "%s\n", error.message);
    exit(1);
}

static int compare(const void *a, const void *b)
{
    double one = *(const double *)a, other = *(const double *)b;

    return (one > other) - (one < other);
}

static double time_pixel(struct bench *bench, const struct pixel *pixels, size_t count)
{
    double seconds[REPEATS];

    (void)time_once(bench, pixels, count);
    for (int i = 0; i < REPEATS; i++)
        seconds[i] = time_once(bench, pixels, count);
    qsort(seconds, REPEATS, sizeof *seconds, compare);
    return seconds[REPEATS / 2] / (double)count;
}

static struct pixel *draw(const struct job *job, size_t count)
{
    struct pixel *pixels = xcalloc(count, sizeof *pixels);

    srandom(1);
    for (size_t i = 0; i < count; i++)
        pixels[i] = (struct pixel){(int)(random() % job->width_px), (int)(random() % job->height_px)};
    return pixels;
}

static double time_link(struct bench *bench)
{
    struct pixel *pixels = draw(&bench->job, counts[0]);
    double first_s = time_once(bench, pixels, counts[0]), again_s = time_once(bench, pixels, counts[0]);

    free(pixels);
    return first_s - again_s;
}

static bool settle(struct job *job, struct error *error)
{
    if (job->quality.method == JOB_METHOD_AUTO) job->quality.method = JOB_METHOD_DRAFT;
    return draft_settle(job, NULL, error);
}

static bool measure(struct bench *bench, const char *path)
{
    struct error error = {{0}};
    char *document = job_document_load(path, NULL, 0, &error);
    bool ok = document && job_document_check(path, document, "/", &bench->job, &error) && settle(&bench->job, &error);
    double whole, link_s;

    free(document);
    if (!ok) {
        fprintf(stderr, "%s\n", error.message);
        return false;
    }
    bench->job.height_px = bench->job.height_px * WIDTH / bench->job.width_px;
    bench->job.width_px = WIDTH;
    bench->job.quality.samples = 1;
    link_s = time_link(bench);
    whole = time_pixel(bench, NULL, (size_t)WIDTH * (size_t)bench->job.height_px);
    printf("%-16s %9.0f %9.2f", bench->job.name, 1e3 * link_s, 1e6 * whole);
    for (int i = 0; i < LIST_COUNT; i++) {
        struct pixel *pixels = draw(&bench->job, counts[i]);

        printf(" %8.2f", time_pixel(bench, pixels, counts[i]) / whole);
        free(pixels);
    }
    printf("\n");
    fflush(stdout);
    job_finish(&bench->job);
    return true;
}

int main(int argc, char *argv[])
{
    struct error error = {{0}};
    struct gl_context *context = gl_context_create(GL_BACKEND_AUTO, NULL, &error);
    struct bench bench = {0};
    int failures = context == NULL;

    if (!context) fprintf(stderr, "%s\n", error.message);
    if (context) bench.renderer = renderer_create(context, NULL);
    if (context) bench.clock = renderer_is_software(bench.renderer) ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
    printf("%-16s %9s %9s", "job", "link/ms", "us/pixel");
    for (int i = 0; i < LIST_COUNT; i++)
        printf(" %8zu", counts[i]);
    printf("\n");
    for (int i = 1; context && i < argc; i++)
        failures += !measure(&bench, argv[i]);
    if (context) {
        renderer_destroy(bench.renderer);
        gl_context_destroy(context);
    }
    return failures > 0;
}
