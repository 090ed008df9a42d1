// What orders of scattering add, and what random paths in double precision cost: orders_bench JOB...
// SPDX-License-Identifier: Apache-2.0
// It runs in the folder to which the jobs' files are relative.
// Over pixels spread evenly over the middle frame: the mean light of up to 2, 5 and all orders over that of the first;
// the noise of one path, which is what 256 paths have times 16; paths a second of processor time.
#include "bench/job_file.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/paths.h"
#include "worker/audit/truth_files.h"
#include "worker/scene/pixel_samples.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { PIXELS = 400, PATHS = 256 };

static const int ORDERS[] = {1, 2, 5, SCENE_ORDERS_ALL};

struct light_sums {
    double mean, squares, noise_squares, seconds;
};

static bool measure(const struct still *still, const struct job *job, int orders, struct light_sums *sums,
                    struct error *error)
{
    struct paths *paths = paths_create(still, orders, error);
    double begin_s = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);

    if (!paths) return false;
    *sums = (struct light_sums){0};
    for (int i = 0; i < PIXELS; i++) {
        // The R2 sequence: Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018.
        double x = fmod(0.5 + 0.7548776662466927 * (i + 1), 1.0), y = fmod(0.5 + 0.5698402909980532 * (i + 1), 1.0);
        struct paths_light light;

        paths_measure_point(paths, x * job->width_px, y * job->height_px, PATHS, (uint64_t)i, &light);
        for (int c = 0; c < 3; c++) {
            sums->mean += light.mean[c] / (3.0 * PIXELS);
            sums->squares += light.mean[c] * light.mean[c];
            sums->noise_squares += light.error[c] * light.error[c] * PATHS;
        }
    }
    sums->seconds = clock_read_s(CLOCK_PROCESS_CPUTIME_ID) - begin_s;
    paths_destroy(paths);
    return true;
}

static bool print_row(const struct job *job, const struct still *still, struct error *error)
{
    double first = 0.0;

    printf("| %s |", job->name);
    for (size_t i = 0; i < sizeof ORDERS / sizeof ORDERS[0]; i++) {
        struct light_sums sums;

        if (!measure(still, job, ORDERS[i], &sums, error)) return false;
        if (ORDERS[i] == 1) {
            first = sums.mean;
            continue;
        }
        printf(" %.3f |", sums.mean / first);
        if (ORDERS[i] == SCENE_ORDERS_ALL)
            printf(" %.2f | %.2g |\n", sqrt(sums.noise_squares / sums.squares), PIXELS * PATHS / sums.seconds);
    }
    return true;
}

static bool bench_job(const char *path, struct error *error)
{
    struct truth_files files = {0};
    struct still still;
    struct job job = {0};
    bool ok = false;
    int32_t frame;

    if (!job_file_load(&job, path, error)) goto out;
    frame = (int32_t)frame_range_at(&job.frames, frame_range_count(&job.frames) / 2);
    if (!truth_files_load(&files, &job, frame, error)) goto out;
    still_init_with_inputs(&still, &job, pixel_samples_time(&job, frame, 0), &files.inputs);
    ok = print_row(&job, &still, error);
out:
    truth_files_finish(&files);
    job_finish(&job);
    return ok;
}

int main(int argc, char *argv[])
{
    struct error error = {{0}};

    printf("| job | 2 orders | 5 | all | noise of a path | paths/s |\n|---|---|---|---|---|---|\n");
    for (int i = 1; i < argc; i++)
        if (!bench_job(argv[i], &error)) fprintf(stderr, "orders_bench: %s: %s\n", argv[i], error.message);
    return EXIT_SUCCESS;
}
