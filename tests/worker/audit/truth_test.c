// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/truth.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/example_job.h"
#include "tests/support/load_texture.h"
#include "worker/scene/pixel_samples.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 24, HEIGHT_PX = 14 };

// Both follow the same rays in double precision; only rounding and the limits of paths tell them apart.
static const double ROUNDING = 1e-9;

static void load(struct job *job, const char *name, double time)
{
    example_job_load(job, name);
    example_job_shrink(job, WIDTH_PX, HEIGHT_PX, time);
    job->quality.samples = 1;
}

static struct truth *open_frame(const struct job *job, int32_t frame)
{
    struct error error = {{0}};
    struct truth *truth = truth_open(&(struct truth_params){.job = job, .frame = frame}, &error);

    if (!truth) fail_msg("%s", error.message);
    return truth;
}

static void make_smooth(struct job *job)
{
    for (size_t i = 0; i < job->scene.object_count; i++) {
        struct timeline *roughness = &job->scene.objects[i].material.roughness;

        timeline_finish(roughness);
        *roughness = (struct timeline){.component_count = 1};
    }
}

static void a_pixel_is_the_references(void **state)
{
    struct still *still = malloc(sizeof *still);
    struct truth *truth;
    struct job job;

    load(&job, "fog", 1.4);
    truth = open_frame(&job, 0);
    still_init(still, &job, 1.4);
    for (int i = 0; i < 5; i++) {
        struct reference_pixel wanted = reference_measure_pixel(still, 5 * i, 7, NULL);
        struct truth_pixel pixel = truth_measure(truth, 5 * i, 7, NULL);

        assert_true(pixel.is_converged);
        for (int c = 0; c < 3; c++) {
            assert_near(pixel.rgb[c], wanted.radiance[c], ROUNDING);
            assert_true(pixel.variance[c] == 0.0);
        }
    }
    truth_close(truth);
    free(still);
    job_finish(&job);
}

// The camera of the fog's job moves, so a sample at a wrong moment or position shows.
static void samples_are_the_renderers_points_and_moments(void **state)
{
    struct reference_sample samples[4];
    struct reference_pixel wanted;
    struct truth_pixel pixel;
    struct truth *truth;
    struct job job;

    load(&job, "fog", 0.0);
    job.quality.samples = 4;
    job.scene.camera.shutter = 24.0;
    truth = open_frame(&job, 3);
    for (int i = 0; i < 4; i++) {
        struct pixel_point point = pixel_samples_point(&job, 3, 9, 8, i);

        samples[i] = (struct reference_sample){
            .x = point.x_px - 9.0, .y = point.y_px - 8.0, .time = pixel_samples_time(&job, 3, i)};
    }
    wanted = reference_measure_samples(&job, NULL, 9, 8, samples, 4, NULL);
    pixel = truth_measure(truth, 9, 8, NULL);
    for (int c = 0; c < 3; c++)
        assert_near(pixel.rgb[c], wanted.radiance[c], ROUNDING);
    truth_close(truth);
    job_finish(&job);
}

static void light_that_the_job_cuts_is_not_missing(void **state)
{
    double deep_sum = 0.0, cut_sum = 0.0;
    struct still *still = malloc(sizeof *still);
    struct still_inputs inputs = {0};
    struct truth *truth;
    struct job job;

    load(&job, "glass", 0.0);
    job.quality.max_depth = 2;
    truth = open_frame(&job, 0);
    load_texture_inputs(&inputs, &job);
    still_init_with_inputs(still, &job, 0.0, &inputs);
    for (int i = 0; i < WIDTH_PX * HEIGHT_PX; i++) {
        struct truth_pixel pixel = truth_measure(truth, i % WIDTH_PX, i / WIDTH_PX, NULL);
        struct reference_pixel cut = reference_measure_pixel(still, i % WIDTH_PX, i / WIDTH_PX, NULL);

        deep_sum += pixel.rgb[0];
        cut_sum += cut.radiance[0];
    }
    print_message("%g of the light is behind more than two bends\n", 1.0 - cut_sum / deep_sum);
    assert_true(deep_sum > 1.001 * cut_sum);
    load_texture_finish(&inputs);
    truth_close(truth);
    free(still);
    job_finish(&job);
}

static bool stop_at_once(void *user)
{
    return false;
}

static void threads_measure_what_one_does(void **state)
{
    enum { COUNT = 30 };
    struct pixel points[COUNT];
    struct truth_pixel pixels[COUNT];
    struct truth_many many = {.points = points, .pixels = pixels, .count = COUNT, .thread_count = 3};
    struct truth *truth;
    struct job job;
    size_t measured;

    load(&job, "fog", 0.0);
    truth = open_frame(&job, 0);
    for (int i = 0; i < COUNT; i++)
        points[i] = (struct pixel){i * 7 % WIDTH_PX, i * 5 % HEIGHT_PX};
    assert_int_equal(truth_measure_many(truth, &many), COUNT);
    for (int i = 0; i < COUNT; i++) {
        struct truth_pixel pixel = truth_measure(truth, points[i].x, points[i].y, NULL);

        assert_memory_equal(pixel.rgb, pixels[i].rgb, sizeof pixel.rgb);
    }
    // In one thread: others might finish before the first one asks.
    many.on_progress = stop_at_once;
    many.thread_count = 1;
    memset(pixels, 0, sizeof pixels);
    measured = truth_measure_many(truth, &many);
    assert_int_equal(measured, 1);
    assert_true(pixels[0].is_converged);
    assert_false(pixels[1].is_converged);
    truth_close(truth);
    job_finish(&job);
}

static void threads_share_the_samples_of_one_pixel(void **state)
{
    const struct pixel point = {11, 7};
    struct truth_pixel pixel, alone;
    struct truth_many many = {.points = &point, .pixels = &pixel, .count = 1, .thread_count = 3};
    struct truth *truth;
    struct job job;

    load(&job, "fog", 0.0);
    job.quality.samples = 16;
    truth = open_frame(&job, 0);
    assert_int_equal(truth_measure_many(truth, &many), 1);
    alone = truth_measure(truth, point.x, point.y, NULL);
    assert_memory_equal(pixel.rgb, alone.rgb, sizeof pixel.rgb);
    // A pixel without all of its samples is not measured.
    many.on_progress = stop_at_once;
    many.thread_count = 1;
    assert_int_equal(truth_measure_many(truth, &many), 0);
    truth_close(truth);
    job_finish(&job);
}

static void rough_surfaces_have_a_variance(void **state)
{
    double rough = 0.0, smooth = 0.0;
    struct truth *truth;
    struct job job;

    load(&job, "opaque", 0.0);
    job.quality.samples = 4;
    truth = open_frame(&job, 0);
    for (int x = 0; x < WIDTH_PX; x++)
        rough += truth_measure(truth, x, 7, NULL).variance[0];
    truth_close(truth);
    make_smooth(&job);
    truth = open_frame(&job, 0);
    for (int x = 0; x < WIDTH_PX; x++)
        smooth += truth_measure(truth, x, 7, NULL).variance[0];
    truth_close(truth);
    assert_true(rough > 0.0);
    assert_true(smooth == 0.0);
    job_finish(&job);
}

static double brightness_of(const struct truth *truth)
{
    double sum = 0.0;

    for (int x = 0; x < WIDTH_PX; x++)
        sum += truth_measure(truth, x, 8, NULL).rgb[0];
    return sum;
}

static void a_sequence_is_read_frame_by_frame(void **state)
{
    struct error error = {{0}};
    struct truth *truth, *later;
    double first, second;
    struct job job;

    load(&job, "smoke", 0.0);
    truth = open_frame(&job, 3);
    first = brightness_of(truth);
    assert_true(truth_seek(truth, 9, &error));
    second = brightness_of(truth);
    later = open_frame(&job, 9);
    assert_near(second, brightness_of(later), ROUNDING);
    assert_true(fabs(second - first) > 0.01 * first);
    assert_false(truth_seek(truth, 1234, &error));
    assert_non_null(strstr(error.message, "1234.nvdb"));
    assert_false(truth_measure(truth, 0, 0, NULL).is_converged);
    truth_close(truth);
    truth_close(later);
    job_finish(&job);
}

static double nothing_at(const void *context, struct vec3 p, double t)
{
    return 0.0;
}

static void the_users_code_needs_a_twin(void **state)
{
    const struct still_function functions[SCENE_MEDIUM_LIMIT] = {{.at = nothing_at}};
    struct error error = {{0}};
    struct truth *truth;
    struct job job;

    load(&job, "custom", 0.0);
    assert_false(truth_has_twin(&job));
    assert_null(truth_open(&(struct truth_params){.job = &job}, &error));
    assert_non_null(strstr(error.message, "GLSL"));
    truth = truth_open(&(struct truth_params){.job = &job, .functions = functions}, &error);
    assert_non_null(truth);
    assert_true(truth_measure(truth, 12, 7, NULL).rgb[0] == 0.0);
    truth_close(truth);
    job_finish(&job);
}

// Light of several orders is a mean of random paths. An audit that followed those by which a plan was made would find
// what the plan found.
static void plans_and_audits_follow_paths_of_their_own(void **state)
{
    const struct integrate_accuracy rough = {.relative = 0.2};
    struct truth_pixel pixels[2];
    struct job job;

    (void)state;
    load(&job, "fog", 1.4);
    job.scene.orders = 2;
    for (int i = 0; i < 2; i++) {
        struct truth *truth = truth_open(&(struct truth_params){.job = &job, .is_for_plan = i == 1}, NULL);

        pixels[i] = truth_measure(truth, 12, 7, &rough);
        truth_close(truth);
    }
    for (int c = 0; c < 3; c++) {
        double noise = fmax(fabs(pixels[0].half[c]), fabs(pixels[1].half[c]));

        assert_true(pixels[0].rgb[c] != pixels[1].rgb[c]);
        assert_true(noise > 0.0 && fabs(pixels[0].rgb[c] - pixels[1].rgb[c]) < 0.5 * pixels[0].rgb[c]);
    }
    job_finish(&job);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pixel_is_the_references),
        cmocka_unit_test(samples_are_the_renderers_points_and_moments),
        cmocka_unit_test(light_that_the_job_cuts_is_not_missing),
        cmocka_unit_test(threads_measure_what_one_does),
        cmocka_unit_test(threads_share_the_samples_of_one_pixel),
        cmocka_unit_test(rough_surfaces_have_a_variance),
        cmocka_unit_test(a_sequence_is_read_frame_by_frame),
        cmocka_unit_test(plans_and_audits_follow_paths_of_their_own),
        cmocka_unit_test(the_users_code_needs_a_twin),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
