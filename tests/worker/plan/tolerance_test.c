// Frames of jobs that state a tolerance: planned, audited, rendered again, failed.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/tolerance.h"

#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "tests/support/tolerance_stage.h"
#include "tests/support/true_error.h"
#include "worker/audit/audit.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_make.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static struct job cloud_job(double tolerance)
{
    struct job job;

    example_job_load(&job, "cloud");
    job.width_px = 32;
    job.height_px = 18;
    job.quality = (struct job_quality){
        .method = JOB_METHOD_AUTO, .tolerance = tolerance, .samples = 1, .max_depth = 8, .max_cut = 1.0};
    return job;
}

static void frames_keep_their_tolerance(void **state)
{
    static const double tolerances[] = {0.1, 0.03, 0.01};
    struct tolerance_stage stage = tolerance_stage_open(NULL);

    for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++) {
        struct job job = cloud_job(tolerances[i]);
        struct tolerance_result result;
        struct error error = {{0}};
        struct image image;
        double truly;

        // A frame of another segment than the last one.
        if (!tolerance_stage_render(stage, &job, 48 * (int32_t)i + 5, &image, &result, &error))
            fail_msg("%s", error.message);
        truly = true_error_measure(&job, 48 * (int32_t)i + 5, &image);
        print_message("tolerance %g: truly %.2e, audited %.2e (at most %.2e): %s\n", tolerances[i], truly,
                      result.audit.error, result.audit.error95, result.reason);
        assert_true(truly <= tolerances[i]);
        assert_true(result.audit.kind == AUDIT_REFERENCE && result.audit.ray_count >= 2 * AUDIT_RAYS_POOLED);
        assert_true(result.audit.tolerance == tolerances[i] && result.reason[0] != 0);
        // A much smaller error would have taken too long.
        assert_true(truly >= 0.1 * tolerances[i]);
        image_finish(&image);
        job_finish(&job);
    }
    tolerance_stage_close(stage);
}

static void equal_renderers_make_equal_frames(void **state)
{
    struct job job = cloud_job(0.05);
    size_t size_bytes = 16 * (size_t)job.width_px * (size_t)job.height_px;
    struct tolerance_result results[2];
    struct image images[2];

    for (int i = 0; i < 2; i++) {
        struct tolerance_stage stage = tolerance_stage_open(NULL);
        struct image other;

        // One renderer has rendered another frame of the segment before.
        if (i == 1) {
            assert_true(tolerance_stage_render(stage, &job, 11, &other, &results[i], NULL));
            image_finish(&other);
        }
        assert_true(tolerance_stage_render(stage, &job, 10, &images[i], &results[i], NULL));
        tolerance_stage_close(stage);
    }
    assert_memory_equal(images[0].rgba, images[1].rgba, size_bytes);
    assert_memory_equal(&results[0].quality, &results[1].quality, sizeof results[0].quality);
    image_finish(&images[0]);
    image_finish(&images[1]);
    job_finish(&job);
}

static struct plan make_plan(struct tolerance_stage stage, const struct job *job, enum plan_choice choice)
{
    enum renderer_fault fault;
    struct error error = {{0}};
    struct plan plan;

    if (!plan_make(&plan,
                   &(struct plan_params){
                       .renderer = stage.gl.renderer, .job = job, .segment = plan_segment_of(job, 0), .choice = choice},
                   &fault, &error))
        fail_msg("%s", error.message);
    return plan;
}

// The work by rays of optical depth 3, all of which meet a medium.
static double work_of(const struct job *job, const struct job_quality *quality)
{
    static const float DEPTH = 3.0F;
    struct plan_scene scene;

    plan_scene_init(&scene, job);
    scene.depths = &DEPTH;
    scene.depth_count = 1;
    scene.hit_share = 1.0;
    return plan_family_work(&scene, quality);
}

static const struct plan_family *find_family(enum job_method method)
{
    size_t i = 0;

    while (plan_families[i].method != method)
        ++i;
    return &plan_families[i];
}

// The quality of a user who halves all steps until the pilot's frames keep the tolerance.
static double work_by_halving(struct tolerance_stage stage, const struct job *job)
{
    static const int32_t frames[] = {0, 23, 47};
    const struct plan_family *family = find_family(JOB_METHOD_MIDPOINT);
    struct plan_scene scene;
    bool is_within = false;
    double work = 0.0;

    plan_scene_init(&scene, job);
    for (int level = 0; !is_within && level < 8; ++level) {
        struct plan_point point = {.rungs = {2 * level, 2 * level, 6}};
        struct job planned = *job;

        planned.quality = plan_family_quality(family, &scene, &point);
        work = work_of(job, &planned.quality);
        is_within = true;
        for (size_t i = 0; is_within && i < sizeof frames / sizeof *frames; ++i) {
            struct image image = tolerance_stage_make_image(job);
            struct renderer_result result;

            assert_true(renderer_render(stage.gl.renderer,
                                        &(struct renderer_frame){.job = &planned, .frame = frames[i], .image = &image},
                                        &result, NULL));
            is_within = true_error_measure(&planned, frames[i], &image) <= job->quality.tolerance;
            image_finish(&image);
        }
    }
    assert_true(is_within);
    return work;
}

static void a_plan_is_as_cheap_as_halving_and_the_finest_is_not(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.02);
    double halving = work_by_halving(stage, &job);
    struct plan plan = make_plan(stage, &job, PLAN_CHOICE_CHEAPEST);
    struct plan finest = make_plan(stage, &job, PLAN_CHOICE_FINEST);

    print_message("evaluations a pixel: %.0f by halving, %.0f by plan, %.0f at the finest\n", halving,
                  work_of(&job, &plan.quality), work_of(&job, &finest.quality));
    // A plan uses at most six tenths of the tolerance.
    assert_true(work_of(&job, &plan.quality) <= 1.5 * halving);
    assert_true(work_of(&job, &finest.quality) > 1.5 * halving);
    assert_true(finest.predicted_error < plan.predicted_error);
    job_finish(&job);
    tolerance_stage_close(stage);
}

enum { PHASES_SIZE = 160 };

struct told {
    char phases[PHASES_SIZE];
    enum frame_phase phase;
    double done;                    // of that phase
    double most[FRAME_PHASE_COUNT]; // that was told of each
};

static void on_phase(void *user, enum frame_phase phase)
{
    struct told *told = user;
    size_t length = strlen(told->phases);

    snprintf(told->phases + length, PHASES_SIZE - length, "%s ", frame_phase_names[phase]);
    told->phase = phase;
    told->done = 0.0;
}

static bool on_progress(void *user, double done)
{
    struct told *told = user;

    assert_true(done >= 0.0 && done <= 1.0);
    assert_true(done == 0.0 || done >= told->done);
    told->done = fmax(told->done, done);
    told->most[told->phase] = fmax(told->most[told->phase], done);
    return true;
}

// The audit of the first rendering is true, and far over the tolerance; another, finer in what is to blame, keeps it.
static void the_coarsest_setting_fails_the_audit(void **state)
{
    static const int32_t frames[] = {3, 45};
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.02), coarsest = job;
    struct plan plan = make_plan(stage, &job, PLAN_CHOICE_COARSEST);

    coarsest.quality = plan.quality;
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        struct image image = tolerance_stage_make_image(&job);
        static const char expected[] = "plan render audit render audit ";
        struct told told = {.phases = ""};
        struct tolerance_params params = {.job = &job,
                                          .serial = 1 + (int64_t)i,
                                          .frame = frames[i],
                                          .image = &image,
                                          .choice = PLAN_CHOICE_COARSEST,
                                          .on_progress = on_progress,
                                          .on_phase = on_phase,
                                          .user = &told};
        struct tolerance_result result;
        struct renderer_result rendered;
        struct error error = {{0}};
        double truly;

        if (!tolerance_render(stage.tolerance, &params, &result, &error)) fail_msg("%s", error.message);
        assert_true(result.retry_count > 0 && result.audit.error <= 0.02);
        assert_memory_equal(told.phases, expected, strlen(expected));
        // The search is the second half of a plan; most audits measure a fourth of what they may.
        assert_true(i > 0 || told.most[FRAME_PHASE_PLAN] > 0.55);
        assert_true(told.most[FRAME_PHASE_AUDIT] > 0.02 && told.most[FRAME_PHASE_RENDER] > 0.99);
        assert_true(true_error_measure(&job, frames[i], &image) <= 0.02);
        assert_true(renderer_render(stage.gl.renderer,
                                    &(struct renderer_frame){.job = &coarsest, .frame = frames[i], .image = &image},
                                    &rendered, NULL));
        truly = true_error_measure(&job, frames[i], &image);
        print_message("frame %d: truly %.2e, audited %.2e\n", (int)frames[i], truly, result.first_error);
        assert_true(truly > 2.0 * 0.02 && result.first_error > 2.0 * 0.02);
        // A pool has pixels of other frames too.
        assert_true(result.first_error < 4.0 * truly && truly < 4.0 * result.first_error);
        image_finish(&image);
    }
    job_finish(&job);
    tolerance_stage_close(stage);
}

static double processor_s(void)
{
    struct timespec now;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// In so small a picture the light's grid takes most of the time, and each frame fills it anew.
static void a_timed_plan_counts_all_that_a_frame_takes(void **state)
{
    enum { FRAMES = 6 };
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.03);
    struct image image;
    struct renderer_result result;
    enum renderer_fault fault;
    double seconds = 0.0;
    struct plan plan;

    // Large enough that light grids repay.
    job.width_px = 160;
    job.height_px = 90;
    image = tolerance_stage_make_image(&job);
    assert_true(plan_make(
        &plan,
        &(struct plan_params){
            .renderer = stage.gl.renderer, .job = &job, .segment = plan_segment_of(&job, 0), .is_timed = true},
        &fault, NULL));
    for (int i = 0; i < FRAMES; i++) {
        struct plan of_frame = plan_of_frame(&plan, &job, 8 * i + 4);
        struct job planned = plan_apply(&of_frame, &job);
        double start_s = processor_s();

        assert_true(renderer_render(stage.gl.renderer,
                                    &(struct renderer_frame){.job = &planned, .frame = 8 * i + 4, .image = &image},
                                    &result, NULL));
        seconds += (processor_s() - start_s) / FRAMES;
    }
    print_message("%s: predicted %.3g s, took %.3g s\n", plan.reason, plan.predicted_processor_s, seconds);
    // Timings scatter; without the grids' they would be a third.
    assert_true(plan.predicted_processor_s > 0.6 * seconds && plan.predicted_processor_s < 3.0 * seconds);
    assert_true(plan.predicted_audit_s > 0.0 && plan.predicted_encode_s > 0.0 && plan.plan_s > 0.0);
    assert_true(plan.predicted_frame_s >= plan.predicted_s + plan.predicted_audit_s);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static void equal_frames_are_copied_with_their_audit(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct tolerance_result first, second;
    struct image images[2];
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", \"quality\": {\"tolerance\": 0.02}");
    assert_true(tolerance_stage_render(stage, &job, 0, &images[0], &first, NULL));
    assert_true(tolerance_stage_render(stage, &job, 1, &images[1], &second, NULL));
    assert_true(first.audit.seconds > 0.0);
    assert_true(second.render.is_copy);
    assert_true(second.audit.kind == AUDIT_REFERENCE && second.audit.error == first.audit.error);
    assert_true(second.audit.ray_count == first.audit.ray_count && second.audit.seconds == 0.0);
    image_finish(&images[0]);
    image_finish(&images[1]);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// Almost all that is seen of the smoke around the lamp is behind a transmittance of a millionth.
static void light_from_deep_inside_is_kept(void **state)
{
    static const char text[] =
        "{\"version\":1,\"name\":\"lamp\",\"frames\":\"0\",\"fps\":24,\"resolution\":[32,18],\"camera\":{\"position\":"
        "[0,0,-2],\"target\":[0,0,0],\"fov\":30},\"lights\":[{\"kind\":\"point\",\"intensity\":60,\"position\":"
        "[0,0,0]}],\"scene\":{\"media\":[{\"sigma_s\":64,\"density\":{\"kind\":\"fold_fractal\",\"iterations\":8,"
        "\"offset\":0.06,\"radius\":0.15,\"rotate_x_rad\":0.6,\"rotate_y_rad\":0.3,\"exponent\":1.3,\"scale\":10}}]},"
        "\"output\":{\"path\":\"lamp.####.exr\"},\"quality\":{\"tolerance\":0.02}}";
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct tolerance_result result;
    struct error error = {{0}};
    struct image image;
    struct job job;
    double truly;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    if (!tolerance_stage_render(stage, &job, 0, &image, &result, &error)) fail_msg("%s", error.message);
    truly = true_error_measure(&job, 0, &image);
    print_message("truly %.2e, audited %.2e: %s\n", truly, result.audit.error, result.reason);
    assert_true(truly <= 0.02);
    assert_true(result.quality.min_transmittance == 0.0);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static bool stop_later(void *user, double done)
{
    return --*(int *)user > 0;
}

static void a_pilot_can_be_stopped(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.05);
    struct image image = tolerance_stage_make_image(&job);

    for (int after = 1; after < 60; after *= 3) {
        struct tolerance_result result;
        int left = after;

        assert_false(tolerance_render(
            stage.tolerance,
            &(struct tolerance_params){
                .job = &job, .serial = 1, .frame = 3, .image = &image, .on_progress = stop_later, .user = &left},
            &result, NULL));
        assert_int_equal(result.render.fault, RENDERER_FAULT_STOPPED);
    }
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static void a_job_that_names_its_method_is_not_audited(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct tolerance_result result;
    struct image image;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    assert_true(tolerance_stage_render(stage, &job, 0, &image, &result, NULL));
    assert_true(result.audit.kind == AUDIT_NONE && result.reason[0] == 0);
    assert_int_equal(result.quality.method, JOB_METHOD_MIDPOINT);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_keep_their_tolerance),
        cmocka_unit_test(equal_renderers_make_equal_frames),
        cmocka_unit_test(a_plan_is_as_cheap_as_halving_and_the_finest_is_not),
        cmocka_unit_test(the_coarsest_setting_fails_the_audit),
        cmocka_unit_test(a_timed_plan_counts_all_that_a_frame_takes),
        cmocka_unit_test(light_from_deep_inside_is_kept),
        cmocka_unit_test(equal_frames_are_copied_with_their_audit),
        cmocka_unit_test(a_pilot_can_be_stopped),
        cmocka_unit_test(a_job_that_names_its_method_is_not_audited),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
