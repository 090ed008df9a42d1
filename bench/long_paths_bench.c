// What light of all orders costs by random paths in double precision: long_paths_bench [SECONDS [NAME]], in jobs/.
// SPDX-License-Identifier: Apache-2.0
// For scenes in which paths are long or lobes narrow, over pixels spread evenly, by SECONDS (8) of one processor each,
// or for those alone whose names begin with NAME: the mean light and its standard error; looks at densities and
// microseconds a path; the standard deviation of a path, relative to the RMS of the light; the kurtosis of paths over
// their pixels' means; the largest share that one path has in the sum of its pixel; milliseconds a pixel to 1 % of the
// RMS; and the shares of pixels brighter than the RMS, of those above a fifth of it and of the others in that time.
#include "bench/job_file.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/paths.h"
#include "worker/audit/truth_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PIXELS = 64, PATHS = 16, WIDTH_PX = 64, HEIGHT_PX = 36, CLASSES = 3 };

#define FAR_LAMP "{ \"kind\": \"point\", \"intensity\": 2, \"falloff\": \"none\", \"position\": [2, 1.5, 2] }"
#define LAMP_INSIDE "{ \"kind\": \"point\", \"intensity\": 2, \"position\": [0.3, 0, 0.1] }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": 3, \"direction\": [-1, -1, -0.5] }"
#define SKY "{ \"kind\": \"dome\", \"gradient\": { \"along\": 0.2, \"against\": 1 } }"
#define EVEN "\"kind\": \"homogeneous\""
#define NOISE                                                                                                          \
    "\"kind\": \"noise\", \"frequency\": 2.5, \"octaves\": 5, \"H\": 0.6, \"lacunarity\": 2, \"bias\": 0.2,"           \
    " \"mode\": \"clip\", \"scale\": 4"

// A ball of radius 1. Its depth is that of its diameter, for a density of 1.
struct setup {
    const char *name, *density, *lights;
    double depth, albedo, g;
};

static const struct setup SETUPS[] = {
    {"20 white .95", EVEN, FAR_LAMP, 20, 1, 0.95},        {"100 .99 .85", EVEN, FAR_LAMP, 100, 0.99, 0.85},
    {"100 .99 .95", EVEN, FAR_LAMP, 100, 0.99, 0.95},     {"100 .9 .99", EVEN, FAR_LAMP, 100, 0.9, 0.99},
    {"100 white .95", EVEN, FAR_LAMP, 100, 1, 0.95},      {"100 white 0", EVEN, FAR_LAMP, 100, 1, 0},
    {"1000 .99 .99", EVEN, FAR_LAMP, 1000, 0.99, 0.99},   {"1000 white .5", EVEN, FAR_LAMP, 1000, 1, 0.5},
    {"inside .9 .9", EVEN, LAMP_INSIDE, 10, 0.9, 0.9},    {"inside .9 .5", EVEN, LAMP_INSIDE, 10, 0.9, 0.5},
    {"inside white .95", EVEN, LAMP_INSIDE, 20, 1, 0.95}, {"noise .99 .85", NOISE, SUN, 40, 0.99, 0.85},
    {"20 white -.9", EVEN, FAR_LAMP, 20, 1, -0.9},        {"inside .9 -.9", EVEN, LAMP_INSIDE, 10, 0.9, -0.9},
    {"20 white -.8", EVEN, FAR_LAMP, 20, 1, -0.8},        {"inside .9 -.5", EVEN, LAMP_INSIDE, 10, 0.9, -0.5},
    {"dome white .85", EVEN, SKY, 100, 1, 0.85},          {"cumulus", NULL, NULL, 0, 0, 0},
};

struct pixel_sums {
    double light, squares, fourths, largest; // of the paths' mean colours; about 0
    double seconds, looks;
};

static bool parse(struct job *job, const struct setup *setup, struct error *error)
{
    double sigma_t = setup->depth / 2.0;
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"bench\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [%d, %d],"
             " \"camera\": { \"position\": [0, 0, 4], \"target\": [0, 0, 0], \"fov\": 32 }, \"lights\": [ %s ],"
             " \"scene\": { \"scattering\": { \"orders\": \"all\" }, \"media\": [ { \"sigma_s\": %.17g,"
             " \"sigma_a\": %.17g, \"phase\": [ { \"g\": %.17g } ], \"density\": { %s, \"bounds\": { \"kind\":"
             " \"sphere\", \"center\": [0, 0, 0], \"radius\": 1 } } } ] },"
             " \"quality\": { \"method\": \"paths\", \"paths\": 8 }, \"output\": { \"path\": \"bench.####.exr\" } }",
             WIDTH_PX, HEIGHT_PX, setup->lights, sigma_t * setup->albedo, sigma_t * (1.0 - setup->albedo), setup->g,
             setup->density);
    return job_parse(job, text, strlen(text), NULL, error);
}

static void add_paths(const struct paths *paths, double x, double y, uint64_t seed, struct pixel_sums *sums)
{
    double begin_s = clock_read_s(CLOCK_THREAD_CPUTIME_ID);

    for (int i = 0; i < PATHS; i++) {
        struct paths_light light;
        double value;

        paths_measure_point(paths, x, y, 1, seed + (uint64_t)i, &light);
        value = (light.mean[0] + light.mean[1] + light.mean[2]) / 3.0;
        sums->looks += light.looks;
        sums->light += value;
        sums->squares += value * value;
        sums->fourths += value * value * value * value;
        sums->largest = fmax(sums->largest, value);
    }
    sums->seconds += clock_read_s(CLOCK_THREAD_CPUTIME_ID) - begin_s;
}

static int class_of(double mean, double rms)
{
    return mean > rms ? 0 : mean > 0.2 * rms ? 1 : 2;
}

static void print_row(const char *name, const struct pixel_sums *sums, double count)
{
    double mean = 0.0, squares = 0.0, variance = 0.0, fourths = 0.0, seconds = 0.0, largest = 0.0, looks = 0.0, rms;
    double classes[CLASSES] = {0.0}, all = 0.0, to_percent;

    for (int i = 0; i < PIXELS; i++) {
        double light = sums[i].light / count;

        mean += light / PIXELS;
        squares += light * light / PIXELS;
        variance += (sums[i].squares / count - light * light) / PIXELS;
        fourths += sums[i].fourths / count / PIXELS;
        seconds += sums[i].seconds / count / PIXELS;
        looks += sums[i].looks / count / PIXELS;
        largest = fmax(largest, sums[i].light > 0.0 ? sums[i].largest / sums[i].light : 0.0);
    }
    rms = sqrt(squares);
    for (int i = 0; i < PIXELS; i++) {
        double light = sums[i].light / count;
        double cost = (sums[i].squares / count - light * light) * sums[i].seconds;

        classes[class_of(light, rms)] += cost;
        all += cost;
    }
    to_percent = 1e3 * seconds * variance / (1e-4 * squares);
    printf("| %s | %.5g +- %.1g %% | %.3g | %.3g | %.2f | %.2g | %.2g %% | %.3g | %.0f, %.0f, %.0f %% |\n", name, mean,
           100.0 * sqrt(variance / (PIXELS * count)) / mean, looks, 1e6 * seconds, sqrt(variance / squares),
           fourths / (variance * variance), 100.0 * largest, to_percent, 100.0 * classes[0] / all,
           100.0 * classes[1] / all, 100.0 * classes[2] / all);
    fflush(stdout);
}

static bool measure(const char *name, const struct job *job, const struct still *still, double limit_s,
                    struct error *error)
{
    struct paths *paths = paths_create(still, job->scene.orders, error);
    struct pixel_sums sums[PIXELS] = {{0}};
    double begin_s = clock_read_s(CLOCK_THREAD_CPUTIME_ID);
    uint64_t count = 0;

    if (!paths) return false;
    while (clock_read_s(CLOCK_THREAD_CPUTIME_ID) - begin_s < limit_s) {
        for (int i = 0; i < PIXELS; i++) {
            // The R2 sequence: Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018.
            double x = fmod(0.5 + 0.7548776662466927 * (i + 1), 1.0), y = fmod(0.5 + 0.5698402909980532 * (i + 1), 1.0);

            // Most of a ball's frame is empty: pixels are those about it.
            if (still->media[0].density.column) x = 0.5 + (x - 0.5) * job->height_px / job->width_px;
            add_paths(paths, x * job->width_px, y * job->height_px, ((uint64_t)i << 40) + count, &sums[i]);
        }
        count += PATHS;
    }
    paths_destroy(paths);
    print_row(name, sums, (double)count);
    return true;
}

static bool bench_setup(const struct setup *setup, double limit_s, struct error *error)
{
    struct truth_files files = {0};
    struct still still;
    struct job job = {0};
    bool ok = setup->density ? parse(&job, setup, error) : job_file_load(&job, "cumulus.json", error);

    if (ok && truth_files_load(&files, &job, 0, error)) {
        still_init_with_inputs(&still, &job, 0.5, &files.inputs);
        ok = measure(setup->name, &job, &still, limit_s, error);
    } else {
        ok = false;
    }
    truth_files_finish(&files);
    job_finish(&job);
    return ok;
}

int main(int argc, char *argv[])
{
    double limit_s = argc > 1 ? strtod(argv[1], NULL) : 8.0;
    struct error error = {{0}};

    printf("| scene | light | looks | us | noise | kurtosis | largest | ms to 1 %% | bright, middle, dark |\n"
           "|---|---|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < sizeof SETUPS / sizeof SETUPS[0]; i++) {
        if (argc > 2 && strncmp(SETUPS[i].name, argv[2], strlen(argv[2])) != 0) continue;
        if (!bench_setup(&SETUPS[i], limit_s, &error))
            fprintf(stderr, "long_paths_bench: %s: %s\n", SETUPS[i].name, error.message);
    }
    return EXIT_SUCCESS;
}
