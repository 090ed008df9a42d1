// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/chart_truth.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/ball_job.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { PATIENCE_S = 600 }; // no search is cut short, however busy the machine is

static void fill(struct image *image, int width, int height, float (*value)(int x, int y))
{
    assert_true(image_init(image, width, height, false, false, NULL));
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 4; c++)
                image->rgba[4 * (y * width + x) + c] = value(x, y);
}

static float spot(int x, int y)
{
    return 0.05f + expf(-0.001f * (float)((x - 200) * (x - 200) + (y - 100) * (y - 100)));
}

// A picture with a wrong hundredth, and small errors at a rim elsewhere.
static float wrong_spot(int x, int y)
{
    return spot(x, y) * (x > 180 && x < 240 && y > 80 && y < 120 ? 1.2f : 1.01f);
}

static float coarse_spot(int x, int y)
{
    return spot(x, y) * (x > 180 && x < 240 ? 1.4f : 1.02f);
}

static const struct chart_truth_pixel TWO[] = {{0, 0, 3.0, {1, 2, 2}, 0}, {1, 0, 1.0, {0, 0, 6}, 0.5}};

static void errors_are_weighted(void **state)
{
    const struct chart_truth truth = {.pixels = (struct chart_truth_pixel *)TWO, .count = 2};
    float rgba[] = {1.5f, 2, 2, 1, 0, 0, 4, 1};
    const struct image image = {.width_px = 2, .height_px = 1, .rgba = rgba};
    struct chart_error error = chart_truth_compare(&truth, &image, JOB_PIXEL_FLOAT);

    // 3 (0.5)^2 + (2^2 - 0.5) of 3 (1 + 4 + 4) + 36.
    assert_float_equal(error.relative_rmse, sqrt((3 * 0.25 + 3.5) / 63.0), 1e-12);
    assert_float_equal(error.largest, 2.0, 1e-12);
}

static void black_light_has_an_absolute_error(void **state)
{
    struct chart_truth_pixel pixels[] = {{0, 0, 1, {0, 0, 0}, 0}, {1, 0, 1, {0, 0, 0}, 0}};
    const struct chart_truth truth = {.pixels = pixels, .count = 2};
    float rgba[] = {0, 0.5f, 0, 1, 0, 0, 0, 1};
    const struct image image = {.width_px = 2, .height_px = 1, .rgba = rgba};

    assert_float_equal(chart_truth_compare(&truth, &image, JOB_PIXEL_FLOAT).relative_rmse, sqrt(0.25 / 6), 1e-12);
}

static void values_that_are_not_finite_are_infinite_errors(void **state)
{
    const struct chart_truth truth = {.pixels = (struct chart_truth_pixel *)TWO, .count = 2};
    float rgba[] = {1, 2, 2, 1, 0, NAN, 6, 1};
    const struct image image = {.width_px = 2, .height_px = 1, .rgba = rgba};

    assert_true(isinf(chart_truth_compare(&truth, &image, JOB_PIXEL_FLOAT).relative_rmse));
}

static void values_are_compared_as_encoded(void **state)
{
    struct chart_truth_pixel pixel = {0, 0, 1, {1.0001, 1.0001, 1.0001}, 0};
    const struct chart_truth truth = {.pixels = &pixel, .count = 1};
    float rgba[] = {1.0001f, 1.0001f, 1.0001f, 1};
    const struct image image = {.width_px = 1, .height_px = 1, .rgba = rgba};

    assert_true(chart_truth_compare(&truth, &image, JOB_PIXEL_FLOAT).largest < 1e-7);
    assert_float_equal(chart_truth_compare(&truth, &image, JOB_PIXEL_HALF).largest, 1e-4, 1e-7); // half stores 1 there
}

static void a_file_keeps_everything(void **state)
{
    const char *path = temp_folder_path(state, "ball.truth");
    const struct chart_truth truth = {
        .scene = "abc", .kind = "reference", .pixels = (struct chart_truth_pixel *)TWO, .count = 2};
    struct chart_truth loaded;
    struct error error = {{0}};

    assert_true(chart_truth_save(&truth, path, &error));
    assert_true(chart_truth_load(&loaded, path, "abc", &error));
    assert_string_equal(loaded.kind, "reference");
    assert_int_equal(loaded.count, 2);
    assert_memory_equal(loaded.pixels, TWO, sizeof TWO);
    chart_truth_finish(&loaded);
    assert_false(chart_truth_load(&loaded, path, "abd", &error));
    assert_non_null(strstr(error.message, "another picture"));
    assert_false(chart_truth_load(&loaded, temp_folder_path(state, "none"), "abc", &error));
}

static void broken_files_are_refused(void **state)
{
    static const char *const broken[] = {"", "marchd-truth 2 abc reference 1\n", "marchd-truth 1 abc reference 1\n",
                                         "marchd-truth 1 abc reference 1\n0 0 1 1 1 1\n",
                                         "marchd-truth 1 abc reference 99999999999\n0 0 1 1 1 1 0\n"};
    const char *path = temp_folder_path(state, "broken.truth");

    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        struct error error = {{0}};
        struct chart_truth loaded;

        assert_true(file_write_atomic(path, broken[i], strlen(broken[i]), &error));
        assert_false(chart_truth_load(&loaded, path, "abc", &error));
        assert_non_null(strstr(error.message, "broken.truth"));
        assert_null(loaded.pixels);
    }
}

static struct chart_truth find(int width, int height, const struct job *job)
{
    struct image finer, coarser, finest;
    struct chart_truth truth;
    struct error error = {{0}};

    fill(&finer, width, height, wrong_spot);
    fill(&coarser, width, height, coarse_spot);
    fill(&finest, width, height, spot);
    if (!chart_truth_find(
            &truth,
            &(struct chart_truth_params){
                .job = job, .finer = &finer, .coarser = &coarser, .finest = &finest, .seconds = PATIENCE_S},
            &error))
        fail_msg("%s", error.message);
    image_finish(&finer);
    image_finish(&coarser);
    image_finish(&finest);
    return truth;
}

static double sum_weights(const struct chart_truth *truth)
{
    double sum = 0;

    for (size_t i = 0; i < truth->count; i++)
        sum += truth->pixels[i].weight;
    return sum;
}

static void compare_wrong(const struct chart_truth *truth, int width, int height, double tolerance)
{
    struct image image;
    double apart = 0, light = 0, error;

    fill(&image, width, height, wrong_spot);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            apart += pow((double)wrong_spot(x, y) - spot(x, y), 2);
            light += pow(spot(x, y), 2);
        }
    error = chart_truth_compare(truth, &image, JOB_PIXEL_FLOAT).relative_rmse;
    assert_float_equal(error / sqrt(apart / light), 1.0, tolerance);
    image_finish(&image);
}

static void small_pictures_are_known_whole(void **state)
{
    struct chart_truth truth;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    job.width_px = 300;
    job.height_px = 200;
    truth = find(300, 200, &job);
    assert_string_equal(truth.kind, "midpoint");
    assert_int_equal(truth.count, 60000);
    assert_float_equal(sum_weights(&truth), 60000, 1e-6);
    compare_wrong(&truth, 300, 200, 1e-6);
    chart_truth_finish(&truth);
    job_finish(&job);
}

// With 200,000 draws the error's standard deviation is well below a hundredth.
static void large_pictures_are_known_by_weights(void **state)
{
    struct chart_truth truth;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    job.width_px = 640;
    job.height_px = 400;
    truth = find(640, 400, &job);
    assert_true(truth.count < 200001);
    assert_float_equal(sum_weights(&truth) / (640 * 400), 1.0, 0.03);
    compare_wrong(&truth, 640, 400, 0.03);
    chart_truth_finish(&truth);
    job_finish(&job);
}

// A ball that only absorbs, before black, has no light; for one that emits the light has a closed form.
static void reference_is_asked(void **state)
{
    const char *medium = "\"sigma_s\": 0, \"sigma_a\": 1, \"emission\": 1";
    struct image finer, coarser;
    struct chart_truth truth;
    struct error error = {{0}};
    struct job job;

    ball_job_parse(&job, medium, BALL_JOB_MIDPOINT);
    job.width_px = 12;
    job.height_px = 8;
    fill(&finer, 12, 8, spot);
    fill(&coarser, 12, 8, coarse_spot);
    assert_true(chart_truth_find(
        &truth, &(struct chart_truth_params){.job = &job, .finer = &finer, .coarser = &coarser, .seconds = PATIENCE_S},
        &error));
    assert_string_equal(truth.kind, "reference");
    assert_int_equal(truth.count, 96);
    for (size_t i = 0; i < truth.count; i++) {
        double x = (truth.pixels[i].x - 5.5) / 4 * tan(20 * acos(-1.0) / 180);
        double y = (truth.pixels[i].y - 3.5) / 4 * tan(20 * acos(-1.0) / 180);
        double square = 1 - 16 * (x * x + y * y) / (1 + x * x + y * y); // of half the path through the ball

        // The fractal's density is 1, except in its outermost layer.
        assert_float_equal(truth.pixels[i].rgb[0], square > 0 ? 1 - exp(-2 * sqrt(square)) : 0, 1e-3);
    }
    chart_truth_finish(&truth);
    image_finish(&finer);
    image_finish(&coarser);
    job_finish(&job);
}

static bool is_wanted(void *user)
{
    return false;
}

static void an_unwanted_truth_is_not_found(void **state)
{
    struct image image;
    struct chart_truth truth;
    struct error error = {{0}};
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    fill(&image, job.width_px, job.height_px, spot);
    assert_false(chart_truth_find(
        &truth,
        &(struct chart_truth_params){
            .job = &job, .finer = &image, .coarser = &image, .seconds = PATIENCE_S, .is_wanted = is_wanted},
        &error));
    assert_true(error.message[0] != 0);
    assert_null(truth.pixels);
    image_finish(&image);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_weighted),
        cmocka_unit_test(black_light_has_an_absolute_error),
        cmocka_unit_test(values_that_are_not_finite_are_infinite_errors),
        cmocka_unit_test(values_are_compared_as_encoded),
        cmocka_unit_test_setup_teardown(a_file_keeps_everything, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(broken_files_are_refused, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(small_pictures_are_known_whole),
        cmocka_unit_test(large_pictures_are_known_by_weights),
        cmocka_unit_test(reference_is_asked),
        cmocka_unit_test(an_unwanted_truth_is_not_found),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
