// Which pixels planned frames trace, and that their audits know what the others lack.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_pixels.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/example_job.h"
#include "tests/support/plan_keeper.h"
#include "tests/support/tolerance_stage.h"
#include "worker/picture/image.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/tolerance.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct job cloud_job(double tolerance)
{
    struct job job;

    example_job_load(&job, "cloud");
    job.width_px = 320;
    job.height_px = 180;
    job.quality = (struct job_quality){
        .method = JOB_METHOD_AUTO, .tolerance = tolerance, .samples = 1, .max_depth = 8, .max_cut = 1.0};
    return job;
}

static struct tolerance_result render(struct tolerance_stage stage, const struct job *job,
                                      const struct job_quality *repeated, struct image *image)
{
    struct tolerance_result result;
    struct error error = {{0}};

    if (!tolerance_render(stage.tolerance,
                          &(struct tolerance_params){.job = job,
                                                     .serial = 1,
                                                     .frame = 120,
                                                     .image = image,
                                                     .repeated = repeated,
                                                     .repeated_number = repeated ? 1 : 0},
                          &result, &error))
        fail_msg("%s", error.message);
    return result;
}

// What the frame lacks beside one of which every pixel is traced, relative to that one's RMS.
static double find_lack(struct tolerance_stage stage, const struct job *job, const struct job_quality *quality,
                        const struct image *image)
{
    struct job traced = *job;
    struct image all = tolerance_stage_make_image(job);
    size_t count = 4 * (size_t)all.width_px * (size_t)all.height_px;
    struct renderer_result result;
    struct error error = {{0}};
    double squares = 0.0, light = 0.0;

    traced.quality = *quality;
    traced.quality.pixels = (struct job_pixels){0};
    if (!renderer_render(stage.gl.renderer, &(struct renderer_frame){.job = &traced, .frame = 120, .image = &all},
                         &result, &error))
        fail_msg("%s", error.message);
    for (size_t i = 0; i < count; i++) {
        double difference = (double)image->rgba[i] - all.rgba[i];

        if (i % 4 == 3) continue;
        squares += difference * difference;
        light += (double)all.rgba[i] * all.rgba[i];
    }
    image_finish(&all);
    return sqrt(squares / light);
}

static void planned_frames_trace_a_part_of_their_pixels(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.02);
    struct image image = tolerance_stage_make_image(&job);
    struct tolerance_result result = render(stage, &job, NULL, &image);
    double lack = find_lack(stage, &job, &result.quality, &image);

    print_message("threshold %g traces %.1f %%, lacks %.2e, audited %.2e of %.2e\n", result.quality.pixels.threshold,
                  100.0 * result.render.traced, lack, result.audit.interpolation_error, result.audit.error);
    assert_int_equal(result.quality.pixels.stride, JOB_STRIDE_DEFAULT);
    assert_in_range((int)(1000.0 * result.render.traced), 20, 600);
    assert_true(result.audit.error <= 0.02 && lack <= 0.7 * 0.02);
    assert_true(lack >= 0.5 * result.audit.interpolation_error && lack <= 2.0 * result.audit.interpolation_error);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// Settings that keep the tolerance by far, but for their pixels.
static void an_audit_sees_what_pixels_lack(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.005);
    struct image image = tolerance_stage_make_image(&job);
    struct tolerance_result planned = render(stage, &job, NULL, &image), result;
    struct job_quality coarse = planned.quality;
    double lack;

    coarse.pixels = (struct job_pixels){.stride = 64, .threshold = 1.0};
    result = render(stage, &job, &coarse, &image);
    lack = find_lack(stage, &job, &coarse, &image);
    print_message("lacks %.2e, audited %.2e, at most %.2e\n", lack, result.audit.error, result.audit.error95);
    assert_true(lack > job.quality.tolerance && result.audit.is_missed);
    assert_true(result.audit.error >= 0.7 * lack && result.audit.error <= 1.4 * lack && result.audit.error95 >= lack);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// The settings stay: another threshold is all that the frame lacks.
static void a_frame_that_lacks_pixels_gets_more_of_them(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct plan_keeper keeper = {0};
    const struct plan_source source = plan_keeper_source(&keeper);
    struct job job = cloud_job(0.02);
    struct image image = tolerance_stage_make_image(&job);
    struct tolerance_params params = {.job = &job, .serial = 1, .frame = 117, .image = &image, .source = &source};
    struct tolerance_result result;
    double step;

    (void)state;
    assert_true(tolerance_render(stage.tolerance, &params, &result, NULL));
    step = keeper.plan.quality.step;
    keeper.plan.quality.pixels = (struct job_pixels){16, 0.5};
    keeper.number++;
    params.frame = 118;
    assert_true(tolerance_render(stage.tolerance, &params, &result, NULL));
    assert_true(result.retry_count > 0 && result.first_error > 0.02 && result.audit.error <= 0.02);
    assert_true(result.quality.step == step);
    assert_true(result.quality.pixels.stride == 0 || result.quality.pixels.threshold < 0.5);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static struct plan make_plan(struct tolerance_stage stage, const struct job *job, enum plan_choice choice)
{
    const struct plan_params params = {
        .renderer = stage.gl.renderer, .job = job, .segment = plan_segment_of(job, 120), .choice = choice};
    enum renderer_fault fault;
    struct error error = {{0}};
    struct plan plan;

    if (!plan_make(&plan, &params, &fault, &error)) fail_msg("%s", error.message);
    assert_true(plan.predicted_traced > 0.0 && plan.predicted_traced <= 1.0);
    assert_true((plan.pixels.stride == 0) == (plan.predicted_traced == 1.0));
    return plan;
}

static struct job_pixels choose(struct tolerance_stage stage, const struct job *job, enum plan_choice choice)
{
    return make_plan(stage, job, choice).pixels;
}

static void every_pixel_is_traced_where_that_is_no_gain(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.05);

    assert_int_equal(choose(stage, &job, PLAN_CHOICE_CHEAPEST).stride, JOB_STRIDE_DEFAULT);
    assert_int_equal(choose(stage, &job, PLAN_CHOICE_FINEST).stride, 0);
    job.width_px = 100;
    job.height_px = 400;
    assert_int_equal(choose(stage, &job, PLAN_CHOICE_CHEAPEST).stride, 0);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static void larger_pictures_have_a_stride_of_the_same_share(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.05);

    (void)state;
    job.height_px = 128;
    job.width_px = 3839;
    assert_int_equal(choose(stage, &job, PLAN_CHOICE_CHEAPEST).stride, 16);
    job.width_px = 3840;
    assert_int_equal(choose(stage, &job, PLAN_CHOICE_CHEAPEST).stride, 32);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// Glints and texture are small, and no guard knows of them.
static void scenes_with_objects_get_a_finer_lattice(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job;

    (void)state;
    example_job_load(&job, "glass");
    free(job.scene.objects[0].material.texture.file); // tiles would have most pixels traced
    job.scene.objects[0].material.texture.file = NULL;
    job.width_px = 640;
    job.height_px = 360;
    job.quality = (struct job_quality){.method = JOB_METHOD_AUTO,
                                       .tolerance = 0.05,
                                       .samples = 1,
                                       .max_depth = 8,
                                       .min_throughput = 0.001,
                                       .max_cut = 1.0};
    assert_int_equal(choose(stage, &job, PLAN_CHOICE_CHEAPEST).stride, 4);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static void a_frame_over_its_tolerance_gets_a_finer_threshold(void **state)
{
    struct plan plan = {.pixels = {16, 0.02}};

    plan_pixels_refine(&plan, 0.02, 0.01);
    assert_int_equal(plan.pixels.stride, 16);
    assert_true(plan.pixels.threshold <= 0.01 && plan.pixels.threshold > 0.001);
    plan_pixels_refine(&plan, 0.002, 0.01);
    assert_true(plan.pixels.threshold <= 0.005);
    for (int i = 0; i < 4; i++)
        plan_pixels_refine(&plan, 0.01, 0.01);
    assert_int_equal(plan.pixels.stride, 0);
}

// What noise does not explain is the pixels' fault.
static void a_frame_by_paths_gets_a_finer_lattice(void **state)
{
    struct plan plan = {.quality = {.method = JOB_METHOD_PATHS}, .pixels = {4, 0.02}};

    assert_false(plan_pixels_refine_paths(&plan, 0.02, 0.028));
    assert_true(plan_pixels_refine_paths(&plan, 0.01, 0.028));
    assert_true(plan.pixels.stride == 2 && plan.pixels.threshold == 0.01);
    assert_true(plan_pixels_refine_paths(&plan, 0.01, 0.028));
    assert_int_equal(plan.pixels.stride, 0);
    assert_false(plan_pixels_refine_paths(&plan, 0.01, 0.028));
    plan = (struct plan){.quality = {.method = JOB_METHOD_CACHED}, .pixels = {4, 0.02}};
    assert_false(plan_pixels_refine_paths(&plan, 0.0, 0.028));
}

// Noise over a floor, which no grid of scattered light shows.
static struct job noise_job(double tolerance)
{
    static const char *const TEXT =
        "{\"version\": 1, \"name\": \"few\", \"frames\": \"120-121\", \"fps\": 1, \"resolution\": [256, 160],"
        " \"camera\": {\"position\": [0, 0.3, 4], \"target\": [0, 0, 0], \"fov\": 40},"
        " \"lights\": [{\"kind\": \"sun\", \"direction\": [-1, -2, -1],"
        " \"intensity\": {\"keys\": [[120, 2], [121, 3]]}}],"
        " \"scene\": {\"scattering\": {\"orders\": \"all\"},"
        " \"objects\": [{\"kind\": \"plane\", \"point\": [0, -1, 0], \"normal\": [0, 1, 0],"
        " \"material\": {\"kind\": \"diffuse\", \"albedo\": [0.5, 0.4, 0.3]}}],"
        " \"media\": [{\"sigma_s\": 2, \"sigma_a\": 0.1, \"density\": {\"kind\": \"noise\", \"frequency\": 1.5,"
        " \"octaves\": 1, \"scale\": 1.5, \"bounds\": {\"kind\": \"sphere\", \"center\": [0, 0, 0],"
        " \"radius\": 1}}}]}, \"quality\": {\"tolerance\": 0.05}, \"output\": {\"path\": \"a.####.exr\"}}";
    struct error error = {{0}};
    struct job job;

    if (!job_parse(&job, TEXT, strlen(TEXT), NULL, &error)) fail_msg("%s", error.message);
    job.quality.tolerance = tolerance;
    return job;
}

// Their noise is what the plan aims at, a repetition has the same bits, and noise is not taken for interpolation.
static void frames_by_paths_trace_a_part_of_their_pixels(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = noise_job(0.015);
    struct image image = tolerance_stage_make_image(&job), again = tolerance_stage_make_image(&job);
    struct tolerance_result result = render(stage, &job, NULL, &image);
    double predicted;

    print_message("%d paths of %.1f %%, stride %d, threshold %g: noise %.2e, audited %.2e, %s\n", result.quality.paths,
                  100.0 * result.render.traced, result.quality.pixels.stride, result.quality.pixels.threshold,
                  result.render.noise, result.audit.error, result.reason);
    assert_int_equal(result.quality.method, JOB_METHOD_PATHS);
    assert_int_equal(result.quality.pixels.stride, 4);
    assert_true(result.render.traced < 0.6);
    assert_true(result.render.noise > 0.3 * 0.015 && result.render.noise < 0.65 * 0.015);
    assert_true(result.audit.error <= 0.015 && result.audit.interpolation_error == 0.0);
    predicted = make_plan(stage, &job, PLAN_CHOICE_CHEAPEST).predicted_error;
    print_message("predicted %.2e\n", predicted);
    assert_true(fabs(predicted / result.render.noise - 1.0) < 0.1);
    (void)render(stage, &job, &result.quality, &again);
    assert_memory_equal(image.rgba, again.rgba, (size_t)4 * 256 * 160 * sizeof *image.rgba);
    image_finish(&again);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
    (void)state;
}

static void a_frame_by_paths_that_lacks_pixels_gets_more_of_them(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct plan_keeper keeper = {0};
    const struct plan_source source = plan_keeper_source(&keeper);
    struct job job = noise_job(0.015);
    struct image image = tolerance_stage_make_image(&job);
    struct tolerance_params params = {.job = &job, .serial = 1, .frame = 120, .image = &image, .source = &source};
    struct tolerance_result result;
    int paths;

    (void)state;
    assert_true(tolerance_render(stage.tolerance, &params, &result, NULL));
    paths = keeper.plan.quality.paths;
    assert_true(keeper.plan.quality.step > 0.0); // without which a job with such pixels is refused
    keeper.plan.quality.pixels = (struct job_pixels){8, 0.5};
    keeper.number++;
    params.frame = 121;
    assert_true(tolerance_render(stage.tolerance, &params, &result, NULL));
    assert_true(result.retry_count > 0 && result.first_error > 0.015 && result.audit.error <= 0.015);
    assert_int_equal(result.quality.paths, paths);
    assert_true(result.quality.pixels.stride < 8);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planned_frames_trace_a_part_of_their_pixels),
        cmocka_unit_test(an_audit_sees_what_pixels_lack),
        cmocka_unit_test(a_frame_that_lacks_pixels_gets_more_of_them),
        cmocka_unit_test(every_pixel_is_traced_where_that_is_no_gain),
        cmocka_unit_test(larger_pictures_have_a_stride_of_the_same_share),
        cmocka_unit_test(scenes_with_objects_get_a_finer_lattice),
        cmocka_unit_test(a_frame_over_its_tolerance_gets_a_finer_threshold),
        cmocka_unit_test(a_frame_by_paths_gets_a_finer_lattice),
        cmocka_unit_test(frames_by_paths_trace_a_part_of_their_pixels),
        cmocka_unit_test(a_frame_by_paths_that_lacks_pixels_gets_more_of_them),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
