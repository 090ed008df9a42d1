// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/pixel_samples.h"

#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/shader_probe.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { PROBE_COUNT = 512, SAMPLE_LIMIT = 1024 };

// A job of 24 frames a second in which something moves.
static struct job moving_job(int samples)
{
    struct job job = {.fps_numerator = 24, .fps_denominator = 1, .quality.samples = samples};

    job.scene.background = (struct timeline){.kind = TIMELINE_LINEAR, .component_count = 1, .linear.rate = {1}};
    return job;
}

static void strata_are_as_square_as_may_be(void **state)
{
    static const int wanted[][3] = {{1, 1, 1}, {2, 2, 1},  {3, 3, 1},  {4, 2, 2},       {6, 3, 2},
                                    {7, 7, 1}, {12, 4, 3}, {16, 4, 4}, {1021, 1021, 1}, {1024, 32, 32}};

    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        int columns, rows;

        pixel_samples_strata(wanted[i][0], &columns, &rows);
        assert_int_equal(columns, wanted[i][1]);
        assert_int_equal(rows, wanted[i][2]);
    }
}

// The stratum, of `count` along one side, that contains a coordinate in [0, 1).
static int stratum_of(float place, int count)
{
    return (int)(place * (float)count);
}

static void each_stratum_holds_one_point(void **state)
{
    // Coordinates are multiples of 2^-20, so that one in a million may lie just before its stratum; none of these does.
    for (int count = 2; count <= SAMPLE_LIMIT; count = count < 32 ? count + 1 : 2 * count) {
        struct job job = moving_job(count);
        int columns, rows;

        pixel_samples_strata(count, &columns, &rows);
        for (int frame = 0; frame < 20; frame++) {
            bool is_taken[SAMPLE_LIMIT] = {false};

            for (int k = 0; k < count; k++) {
                struct pixel_point point = pixel_samples_point(&job, frame, 0, 0, k);
                int stratum = stratum_of(point.y_px, rows) * columns + stratum_of(point.x_px, columns);

                assert_true(point.x_px >= 0 && point.x_px < 1 && point.y_px >= 0 && point.y_px < 1);
                assert_false(is_taken[stratum]);
                is_taken[stratum] = true;
            }
        }
    }
}

// Points of each sample number, which stands for a time, are uniform in the pixel over many pixels. Means and mean
// squares are those of a uniform number in [0, 1), and x and y are uncorrelated.
static void point_and_time_are_independent(void **state)
{
    enum { SIDE = 200 };
    static const int counts[] = {2, 3, 4, 9, 16};
    // The mean of SIDE^2 uniform numbers in [0, 1) is within five of its standard deviations.
    const double tolerance = 5 * sqrt(1.0 / 12) / SIDE;

    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        struct job job = moving_job(counts[i]);

        for (int k = 0; k < counts[i]; k++) {
            double sum_x = 0, sum_y = 0, squares_x = 0, products = 0;

            for (int pixel = 0; pixel < SIDE * SIDE; pixel++) {
                int x = pixel % SIDE, y = pixel / SIDE;
                struct pixel_point point = pixel_samples_point(&job, 1, x, y, k);
                double offset_x = (double)point.x_px - x, offset_y = (double)point.y_px - y;

                sum_x += offset_x;
                sum_y += offset_y;
                squares_x += offset_x * offset_x;
                products += (offset_x - 0.5) * (offset_y - 0.5);
            }
            assert_near(sum_x / (SIDE * SIDE), 0.5, tolerance);
            assert_near(sum_y / (SIDE * SIDE), 0.5, tolerance);
            assert_near(squares_x / (SIDE * SIDE), 1.0 / 3, tolerance);
            assert_near(products / (SIDE * SIDE), 0, tolerance);
        }
    }
}

// Strata of two successive samples are equally often each pair of strata.
static void the_order_of_strata_is_any(void **state)
{
    enum { COUNT = 4, TRIALS = 40000, PAIRS = COUNT * (COUNT - 1) };
    struct job job = moving_job(COUNT);
    int seen[COUNT][COUNT] = {{0}};

    for (int trial = 0; trial < TRIALS; trial++) {
        int strata[2];

        for (int k = 0; k < 2; k++) {
            struct pixel_point point = pixel_samples_point(&job, trial, 0, 0, k);

            strata[k] = stratum_of(point.x_px, 2) + 2 * stratum_of(point.y_px, 2);
        }
        seen[strata[0]][strata[1]]++;
    }
    // Shares of 1/12 within a quarter of themselves: the shuffle is a simple one, its orders not exactly alike.
    for (int a = 0; a < COUNT; a++)
        for (int b = 0; b < COUNT; b++)
            assert_near(seen[a][b] / (double)TRIALS, a == b ? 0 : 1.0 / PAIRS, a == b ? 0 : 0.25 / PAIRS);
}

static void points_differ_by_pixel_and_frame(void **state)
{
    struct job job = moving_job(4), still = {.quality.samples = 4};
    struct pixel_point point = pixel_samples_point(&job, 3, 10, 20, 1);
    struct pixel_point next = pixel_samples_point(&job, 3, 11, 20, 1);

    assert_true(point.x_px != pixel_samples_point(&job, 4, 10, 20, 1).x_px);
    assert_true(point.x_px - 10 != next.x_px - 11);
    assert_true(point.x_px == pixel_samples_point(&job, 3, 10, 20, 1).x_px);
    // Nothing moves: all frames are one picture.
    point = pixel_samples_point(&still, 3, 10, 20, 1);
    next = pixel_samples_point(&still, 4, 10, 20, 1);
    assert_true(point.x_px == next.x_px && point.y_px == next.y_px);
    still.quality.samples = 1;
    point = pixel_samples_point(&still, 3, 10, 20, 0);
    assert_true(point.x_px == 10.5f && point.y_px == 20.5f);
}

static void times_are_the_middles_of_the_shutters_parts(void **state)
{
    struct job job = moving_job(4);

    assert_near(pixel_samples_time(&job, 48, 3), 2, 0);
    job.scene.camera.shutter = 0.5; // open for 1/48 s
    assert_near(pixel_samples_time(&job, 48, 0), 2 + 0.125 / 48, 1e-15);
    assert_near(pixel_samples_time(&job, 48, 3), 2 + 0.875 / 48, 1e-15);
    assert_near(pixel_samples_middle(&job, 48), 2 + 0.5 / 48, 1e-15);
    job.quality.samples = 1;
    assert_near(pixel_samples_time(&job, 48, 0), 2 + 0.5 / 48, 1e-15);
}

static void the_shader_finds_the_same_points(void **state)
{
    static const char *const modules[] = {"math/random.glsl", "camera/pixel_samples.glsl", NULL};
    static const int counts[] = {2, 3, 4, 5, 7, 16, 36, 100, 1000, 1021, 1024};
    static float inputs[PROBE_COUNT][4], outputs[PROBE_COUNT][4];

    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        struct job job = moving_job(counts[i]);
        int columns, rows;
        char body[512];

        pixel_samples_strata(counts[i], &columns, &rows);
        snprintf(
            body, sizeof body,
            "vec4 probe(int i) {\n"
            "    uvec4 of = uvec4(inputs[i]);\n"
            "    return vec4(pixel_samples_point(PixelSamples(%du, %du), of.xy, of.z, of.w), random_next(), 0.0);\n"
            "}\n",
            columns, rows);
        for (int k = 0; k < PROBE_COUNT; k++) {
            const int input[4] = {k % 7 == 0 ? 16383 - k : 3 * k, k % 5 == 0 ? 9000 + k : k, k % counts[i],
                                  k % 3 == 0 ? 9999999 - k : k / 4};

            for (int c = 0; c < 4; c++)
                inputs[k][c] = (float)input[c];
        }
        shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                       .body = body,
                                                       .inputs = (const float(*)[4])inputs,
                                                       .input_count = PROBE_COUNT,
                                                       .count = PROBE_COUNT},
                         outputs);
        for (int k = 0; k < PROBE_COUNT; k++) {
            struct pixel_point point = pixel_samples_point(&job, (int32_t)inputs[k][3], (int)inputs[k][0],
                                                           (int)inputs[k][1], (int)inputs[k][2]);

            assert_memory_equal(&point, outputs[k], sizeof point);
            assert_true(outputs[k][2] >= 0 && outputs[k][2] < 1);
        }
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strata_are_as_square_as_may_be),
        cmocka_unit_test(each_stratum_holds_one_point),
        cmocka_unit_test(point_and_time_are_independent),
        cmocka_unit_test(the_order_of_strata_is_any),
        cmocka_unit_test(points_differ_by_pixel_and_frame),
        cmocka_unit_test(times_are_the_middles_of_the_shutters_parts),
        cmocka_unit_test(the_shader_finds_the_same_points),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
