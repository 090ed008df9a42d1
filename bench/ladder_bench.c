// Time against error of a frame: ladder_bench [--frame N] [--once | --runs N] [--first] TRUTH STRIDE JOB...
// SPDX-License-Identifier: Apache-2.0
// The jobs show the same scene at the same size with different methods. The file TRUTH has the light of every STRIDE-th
// pixel and row, from STRIDE / 2 on, as doubles; it is measured when it is missing. With --once, times are of one
// rendering, compiling and reading included, and the truth is converged to 1e-3. ladder_bench [--frame N] --extent JOB
// prints the distances, in metres, between which camera rays meet media. With --first, the picture of the first job
// takes the place of reference/. --runs says how many frames are timed after the first one (5). Lines have wall and CPU
// seconds, the relative RMSE, the share of pixels traced, and the job.
#include "bench/job_file.h"
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/reference.h"
#include "worker/audit/truth.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/scene/scene_extent.h"
#include "worker/scene/scene_inputs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RUNS_DEFAULT = 5 };

struct ladder {
    struct renderer *renderer;
    const char *truth;
    int stride;
    int32_t frame;
    int runs;
    bool is_once;
    bool is_first_true;
};

static struct pixel *list_points(const struct job *job, int stride, size_t *count)
{
    size_t limit = (size_t)job->width_px * (size_t)job->height_px;
    struct pixel *points = xcalloc(limit, sizeof *points);

    *count = 0;
    for (int y = stride / 2; y < job->height_px; y += stride)
        for (int x = stride / 2; x < job->width_px; x += stride)
            points[(*count)++] = (struct pixel){x, y};
    return points;
}

static bool measure_truth(const struct ladder *ladder, const struct job *job, const struct pixel *points, size_t count,
                          double *light, struct error *error)
{
    static const struct integrate_accuracy rough = {.relative = 1e-3};
    struct truth *truth = truth_open(&(struct truth_params){.job = job, .frame = ladder->frame}, error);
    struct truth_pixel *pixels = xcalloc(count, sizeof *pixels);

    if (truth) {
        truth_measure_many(truth, &(struct truth_many){.points = points,
                                                       .pixels = pixels,
                                                       .count = count,
                                                       .accuracy = ladder->is_once ? &rough : NULL});
        for (size_t i = 0; i < 3 * count; i++)
            light[i] = pixels[i / 3].rgb[i % 3];
    }
    truth_close(truth);
    free(pixels);
    return truth != NULL;
}

static bool load_truth(const struct ladder *ladder, const struct job *job, const struct pixel *points, size_t count,
                       double *light, struct error *error)
{
    const char *path = ladder->truth;
    FILE *file = fopen(path, "re");
    bool ok = file && fread(light, 3 * sizeof *light, count, file) == count;

    if (file) {
        fclose(file);
        if (!ok) error_set(error, "%s: expected the light of %zu pixels", path, count);
        return ok;
    }
    if (!measure_truth(ladder, job, points, count, light, error)) return false;
    file = fopen(path, "we");
    ok = file && fwrite(light, 3 * sizeof *light, count, file) == count;
    if (file && fclose(file) != 0) ok = false;
    if (!ok) error_set(error, "%s: cannot be written", path);
    return ok;
}

// The first frame compiles and reads; the fastest of the others counts. `best` has wall and CPU seconds and the share
// of pixels traced.
static bool render(const struct ladder *ladder, const struct job *job, struct image *image, double best[static 3],
                   struct error *error)
{
    int runs = ladder->is_once ? 1 : ladder->runs;

    best[0] = best[1] = 1e30;
    best[2] = 0.0;
    for (int i = ladder->is_once ? 0 : runs; i >= 0; i--) {
        double wall = clock_read_s(CLOCK_MONOTONIC), cpu = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);
        struct renderer_result result;

        if (!renderer_render(ladder->renderer,
                             &(struct renderer_frame){.job = job, .frame = ladder->frame + i, .image = image}, &result,
                             error))
            return false;
        wall = clock_read_s(CLOCK_MONOTONIC) - wall;
        cpu = clock_read_s(CLOCK_PROCESS_CPUTIME_ID) - cpu;
        if (i < runs && wall < best[0]) best[0] = wall;
        if (i < runs && cpu < best[1]) best[1] = cpu;
        best[2] = result.traced;
    }
    return true;
}

static bool save_truth(const char *path, const float *light, size_t count, struct error *error)
{
    FILE *file = fopen(path, "we");
    bool ok = file != NULL;

    for (size_t i = 0; ok && i < count; i++)
        ok = fwrite(&(double){(double)light[i]}, sizeof(double), 1, file) == 1;
    if (file && fclose(file) != 0) ok = false;
    if (!ok) error_set(error, "%s: cannot be written", path);
    return ok;
}

static bool print_job(struct ladder *ladder, const char *path, struct error *error)
{
    struct pixel *points = NULL;
    struct reference_error found;
    struct image image = {0};
    struct job job = {0};
    double *light = NULL, best[3];
    float *seen = NULL;
    size_t count;
    bool ok = job_file_load(&job, path, error) && image_init(&image, job.width_px, job.height_px, false, false, error);

    if (!ok) goto out;
    points = list_points(&job, ladder->stride, &count);
    light = xcalloc(3 * count, sizeof *light);
    seen = xcalloc(3 * count, sizeof *seen);
    ok = (ladder->is_first_true || load_truth(ladder, &job, points, count, light, error)) &&
         render(ladder, &job, &image, best, error);
    if (!ok) goto out;
    for (size_t i = 0; i < 3 * count; i++) {
        const struct pixel *point = &points[i / 3];

        seen[i] = image.rgba[4 * ((size_t)point->y * (size_t)job.width_px + (size_t)point->x) + i % 3];
    }
    if (ladder->is_first_true) {
        ladder->is_first_true = false;
        ok = save_truth(ladder->truth, seen, 3 * count, error) && load_truth(ladder, &job, points, count, light, error);
        if (!ok) goto out;
    }
    found = reference_image_error(seen, light, 3 * count);
    printf("%.6f %.6f %.6e %.5f %s\n", best[0], best[1], found.relative_rmse, best[2], path);
    fflush(stdout);
out:
    free(seen);
    free(light);
    free(points);
    image_finish(&image);
    job_finish(&job);
    return ok;
}

static bool print_reach(const char *path, int32_t frame, struct error *error)
{
    struct job job = {0};
    struct scene_inputs inputs = {0};
    bool ok = job_file_load(&job, path, error) && scene_inputs_open(&inputs, &job, frame, NULL, NULL, error);

    if (ok) {
        struct scene_extent extent = scene_extent_find(&job, &inputs, frame);

        printf("%.9g %.9g\n", extent.near, extent.far);
    }
    scene_inputs_finish(&inputs);
    job_finish(&job);
    return ok;
}

static int measure(struct ladder *ladder, char *jobs[])
{
    struct error error = {0};
    struct gl_context *context = gl_context_create(GL_BACKEND_SOFTWARE, NULL, &error);
    bool ok = context != NULL;

    if (!ok) fprintf(stderr, "%s\n", error.message);
    ladder->renderer = context ? renderer_create(context, NULL) : NULL;
    for (; ok && *jobs; jobs++) {
        ok = print_job(ladder, *jobs, &error);
        if (!ok) fprintf(stderr, "%s: %s\n", *jobs, error.message);
    }
    if (ladder->renderer) renderer_destroy(ladder->renderer);
    if (context) gl_context_destroy(context);
    return !ok;
}

int main(int argc, char *argv[])
{
    struct ladder ladder = {.runs = RUNS_DEFAULT};
    struct error error = {0};
    bool is_extent = false;
    char **left = argv + 1;

    for (; *left && !strncmp(*left, "--", 2); left++) {
        if (!strcmp(*left, "--frame") && left[1]) ladder.frame = atoi(*++left);
        if (!strcmp(*left, "--runs") && left[1]) ladder.runs = atoi(*++left);
        if (!strcmp(*left, "--once")) ladder.is_once = true;
        if (!strcmp(*left, "--first")) ladder.is_first_true = true;
        if (!strcmp(*left, "--extent")) is_extent = true;
    }
    if (is_extent && left[0]) {
        if (print_reach(left[0], ladder.frame, &error)) return 0;
        fprintf(stderr, "%s: %s\n", left[0], error.message);
        return 1;
    }
    ladder.stride = argc - (left - argv) > 2 ? atoi(left[1]) : 0;
    if (ladder.stride < 1 || ladder.runs < 1) {
        fprintf(stderr, "usage: ladder_bench [--frame N] [--once | --runs N] [--first] TRUTH STRIDE JOB... |\n"
                        "       ladder_bench [--frame N] --extent JOB\n");
        return 2;
    }
    ladder.truth = left[0];
    return measure(&ladder, left + 2);
}
