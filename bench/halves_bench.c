// What pictures of all orders are off by: halves_bench [--frame N] TRUTH STRIDE PATHS JOB [PICTURE...]
// SPDX-License-Identifier: Apache-2.0
// Of every STRIDE-th pixel and row, from STRIDE / 2 on, two halves of PATHS random paths each are measured in double
// precision where the file TRUTH is missing. It has their means as doubles, as ladder_bench reads them, and TRUTH.half
// has half of their differences. The first line is the noise of the mean, relative to its RMS, and the paths a second
// of processor time (0: read). Then each picture, an EXR file of the job's size, has a line: its relative RMSE, what it
// may be with two standard errors less and more, its mean light over the truth's, and its name. The squared error is
// the mean of the products of both halves' differences, so the noise of the truth is not in it.
#include "cli/job/job_document.h"
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/paths.h"
#include "worker/audit/truth_files.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/scene/pixel_samples.h"

#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { THREADS = 2, PATH_SIZE = 4096 };

// Seeds are no audit's: those are mixed.
static const uint64_t SEED = 0x68616c7665730000u;

struct halves {
    struct job job;
    int32_t frame;
    int stride, columns, rows;
    long paths;
    double *mean, *half; // 3 a pixel
    struct still still;
    struct paths *walker;
    atomic_int next; // the first pixel that no thread has taken
};

static size_t count_values(const struct halves *halves)
{
    return (size_t)3 * (size_t)halves->columns * (size_t)halves->rows;
}

static int place_of(const struct halves *halves, int index)
{
    return halves->stride / 2 + index * halves->stride;
}

static void *measure_pixels(void *user)
{
    struct halves *halves = user;
    int i;

    while ((i = atomic_fetch_add(&halves->next, 1)) < halves->columns * halves->rows) {
        double x = place_of(halves, i % halves->columns) + 0.5, y = place_of(halves, i / halves->columns) + 0.5;
        struct paths_light lights[2];

        for (int k = 0; k < 2; k++)
            paths_measure_point(halves->walker, x, y, halves->paths, SEED + 2 * (uint64_t)i + (uint64_t)k, &lights[k]);
        for (int c = 0; c < 3; c++) {
            halves->mean[3 * i + c] = 0.5 * (lights[0].mean[c] + lights[1].mean[c]);
            halves->half[3 * i + c] = 0.5 * (lights[0].mean[c] - lights[1].mean[c]);
        }
    }
    return NULL;
}

static bool measure(struct halves *halves, struct error *error)
{
    struct truth_files files = {0};
    pthread_t threads[THREADS];
    int started = 0;

    if (!truth_files_load(&files, &halves->job, halves->frame, error)) return false;
    still_init_with_inputs(&halves->still, &halves->job, pixel_samples_time(&halves->job, halves->frame, 0),
                           &files.inputs);
    halves->walker = paths_create(&halves->still, halves->job.scene.orders, error);
    if (halves->walker) {
        while (started < THREADS - 1 && pthread_create(&threads[started], NULL, measure_pixels, halves) == 0)
            started++;
        measure_pixels(halves);
        for (int i = 0; i < started; i++)
            (void)pthread_join(threads[i], NULL);
    }
    paths_destroy(halves->walker);
    truth_files_finish(&files);
    return halves->walker != NULL;
}

static bool exchange(const char *path, double *values, size_t count, bool writes)
{
    FILE *file = fopen(path, writes ? "we" : "re");
    bool ok = file && (writes ? fwrite(values, sizeof *values, count, file)
                              : fread(values, sizeof *values, count, file)) == count;

    if (file && fclose(file) != 0) ok = false;
    return ok;
}

static bool load(struct halves *halves, const char *path, double *paths_a_second, struct error *error)
{
    char beside[PATH_SIZE];
    size_t count = count_values(halves);
    double begin_s = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);

    *paths_a_second = 0.0;
    (void)snprintf(beside, sizeof beside, "%s.half", path);
    if (access(path, F_OK) == 0) {
        if (exchange(path, halves->mean, count, false) && exchange(beside, halves->half, count, false)) return true;
        error_set(error, "%s: expected the light of %zu pixels, and its halves beside it", path, count / 3);
        return false;
    }
    if (!measure(halves, error)) return false;
    *paths_a_second =
        2.0 * (double)halves->paths * (double)(count / 3) / (clock_read_s(CLOCK_PROCESS_CPUTIME_ID) - begin_s);
    if (exchange(path, halves->mean, count, true) && exchange(beside, halves->half, count, true)) return true;
    error_set(error, "%s: cannot be written", path);
    return false;
}

// Over pixels: the mean and the variance of the mean of the products, the mean square and the mean light.
struct error_sums {
    double square, variance, light_square, light, seen;
};

static struct error_sums sum_errors(const struct halves *halves, const struct image *image)
{
    int count = halves->columns * halves->rows;
    struct error_sums sums = {0};
    double squares = 0.0;

    for (int i = 0; i < count; i++) {
        size_t at = (size_t)place_of(halves, i / halves->columns) * (size_t)halves->job.width_px +
                    (size_t)place_of(halves, i % halves->columns);
        double product = 0.0;

        for (int c = 0; c < 3; c++) {
            double mean = halves->mean[3 * i + c], half = halves->half[3 * i + c];
            double seen = image ? (double)image->rgba[4 * at + (size_t)c] : mean;

            product += image ? (seen - mean) * (seen - mean) - half * half : half * half;
            sums.light_square += (mean * mean - half * half) / count;
            sums.light += mean / count;
            sums.seen += seen / count;
        }
        sums.square += product / count;
        squares += product * product / count;
    }
    sums.variance = fmax(squares - sums.square * sums.square, 0.0) / count;
    return sums;
}

static double root_of(double square, double light_square)
{
    return sqrt(fmax(square, 0.0) / light_square);
}

static bool print_picture(const struct halves *halves, const char *path, struct error *error)
{
    struct image image = {0};
    int file = open(path, O_RDONLY | O_CLOEXEC);
    bool ok = file >= 0 && image_exr_read(file, &image, NULL, 1, error);

    if (file < 0) error_set(error, "%s: cannot be opened", path);
    if (file >= 0) close(file);
    if (ok && (image.width_px != halves->job.width_px || image.height_px != halves->job.height_px)) {
        error_set(error, "%s: expected the job's size", path);
        ok = false;
    }
    if (ok) {
        struct error_sums sums = sum_errors(halves, &image);
        double two = 2.0 * sqrt(sums.variance);

        printf("%.6f %.6f %.6f %.5f %s\n", root_of(sums.square, sums.light_square),
               root_of(sums.square - two, sums.light_square), root_of(sums.square + two, sums.light_square),
               sums.seen / sums.light, path);
    }
    image_finish(&image);
    return ok;
}

static bool run(struct halves *halves, const char *truth, char *pictures[], struct error *error)
{
    struct error_sums noise;
    double paths_a_second;

    halves->columns = (halves->job.width_px - halves->stride / 2 + halves->stride - 1) / halves->stride;
    halves->rows = (halves->job.height_px - halves->stride / 2 + halves->stride - 1) / halves->stride;
    halves->mean = xcalloc(count_values(halves), sizeof *halves->mean);
    halves->half = xcalloc(count_values(halves), sizeof *halves->half);
    if (!load(halves, truth, &paths_a_second, error)) return false;
    noise = sum_errors(halves, NULL);
    printf("%.6f %.4g\n", root_of(noise.square, noise.light_square), paths_a_second);
    for (; *pictures; pictures++)
        if (!print_picture(halves, *pictures, error)) return false;
    return true;
}

int main(int argc, char *argv[])
{
    static struct halves halves;
    struct error error = {{0}};
    char **left = argv + 1, *document;
    bool states_frame = argc > 2 && !strcmp(argv[1], "--frame"), ok;

    if (states_frame) left += 2;
    if (argc - (left - argv) < 4) {
        fprintf(stderr, "usage: halves_bench [--frame N] TRUTH STRIDE PATHS JOB [PICTURE...]\n");
        return 2;
    }
    halves.stride = atoi(left[1]);
    halves.paths = atol(left[2]);
    document = job_document_load(left[3], NULL, 0, &error);
    ok = document && job_document_check(left[3], document, "/", &halves.job, &error);
    free(document);
    if (ok) {
        halves.frame = states_frame ? atoi(argv[2]) : (int32_t)frame_range_at(&halves.job.frames, 0);
        ok = halves.stride > 0 && halves.paths > 0 && run(&halves, left[0], left + 4, &error);
        job_finish(&halves.job);
    }
    if (!ok) fprintf(stderr, "halves_bench: %s\n", error.message);
    free(halves.mean);
    free(halves.half);
    return !ok;
}
