// What a pixel's truth costs: truth_bench JOB..., in the folder to which the jobs' files are relative.
// SPDX-License-Identifier: Apache-2.0
// Prints CPU milliseconds a pixel of one sample, and the actual relative error, at each accuracy that is asked for:
// over pixels spread evenly over the middle frame, against the light at an accuracy of 1e-5. As in audits, a pixel
// darker than a tenth of the frame's RMS counts as that bright.
#include "bench/job_file.h"
#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { PIXELS = 100 };

static const double ASKED[] = {1e-4, 1e-3, 1e-2, 1e-1};

// By the R2 sequence: Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018.
static struct pixel point_of(const struct job *job, int index)
{
    double x = fmod(0.5 + 0.7548776662466927 * (index + 1), 1.0), y = fmod(0.5 + 0.5698402909980532 * (index + 1), 1.0);

    return (struct pixel){(int)(x * job->width_px), (int)(y * job->height_px)};
}

// Returns the seconds of the process.
static double measure(const struct truth *truth, const struct job *job, const struct integrate_accuracy *accuracy,
                      struct truth_pixel pixels[static PIXELS])
{
    double begin_s = clock_read_s(CLOCK_PROCESS_CPUTIME_ID);

    for (int i = 0; i < PIXELS; i++) {
        struct pixel point = point_of(job, i);

        pixels[i] = truth_measure(truth, point.x, point.y, accuracy);
    }
    return clock_read_s(CLOCK_PROCESS_CPUTIME_ID) - begin_s;
}

static double root_mean_square(const struct truth_pixel *pixels, const struct truth_pixel *less)
{
    double sum = 0.0;

    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++) {
            double value = pixels[i].rgb[c] - (less ? less[i].rgb[c] : 0.0);

            sum += value * value;
        }
    return sqrt(sum / (3.0 * PIXELS));
}

static void print_costs(const struct truth *truth, const struct job *job)
{
    struct truth_pixel exact[PIXELS], pixels[PIXELS];
    double rms;

    measure(truth, job, &(struct integrate_accuracy){.relative = 1e-5}, exact);
    rms = root_mean_square(exact, NULL);
    printf("| %s |", job->name);
    for (size_t i = 0; i < sizeof ASKED / sizeof ASKED[0]; i++) {
        const struct integrate_accuracy accuracy = {.relative = ASKED[i], .floor = audit_map_floor(rms)};
        double seconds = measure(truth, job, &accuracy, pixels);

        printf(" %.2g | %.1e |", 1e3 * seconds / PIXELS, root_mean_square(pixels, exact) / rms);
    }
    printf("\n");
}

static bool bench_job(const char *path, struct error *error)
{
    struct truth *truth = NULL;
    struct job job = {0};

    if (!job_file_load(&job, path, error)) goto out;
    job.quality.samples = 1;
    truth = truth_open(
        &(struct truth_params){.job = &job,
                               .frame = (int32_t)frame_range_at(&job.frames, frame_range_count(&job.frames) / 2)},
        error);
    if (truth) print_costs(truth, &job);
out:
    truth_close(truth);
    job_finish(&job);
    return truth != NULL;
}

int main(int argc, char *argv[])
{
    struct error error = {{0}};

    printf(
        "| job | ms at 1e-4 | off | 1e-3 | off | 1e-2 | off | 1e-1 | off |\n|---|---|---|---|---|---|---|---|---|\n");
    for (int i = 1; i < argc; i++)
        if (!bench_job(argv[i], &error)) fprintf(stderr, "truth_bench: %s: %s\n", argv[i], error.message);
    return EXIT_SUCCESS;
}
