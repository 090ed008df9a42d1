// Code that gives NaN or infinity is found by its line, whatever types its variables have.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "tests/support/tolerance_stage.h"
#include "worker/picture/image.h"
#include "worker/plan/finite_check.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_params.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct job make_job_of(const char *medium, const char *source)
{
    struct error error = {{0}};
    struct job job;
    char *text =
        xasprintf("{\"version\": 1, \"name\": \"broken\", \"frames\": \"0-47\", \"fps\": 24, \"resolution\": [64, 36],"
                  " \"camera\": {\"position\": [0, 0, -2], \"target\": [0, 0, 0], \"fov\": 50},"
                  " \"lights\": [{\"kind\": \"point\", \"intensity\": 60, \"position\": [1.5, 1, 0]}],"
                  " \"scene\": {\"media\": [{%s, \"density\": {\"kind\": \"glsl\", \"source\": \"%s\","
                  " \"bounds\": {\"kind\": \"sphere\", \"radius\": 1}}}]},"
                  " \"quality\": {\"tolerance\": 0.05}, \"output\": {\"path\": \"broken.####.exr\"}}",
                  medium, source);

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    free(text);
    return job;
}

static struct job make_job(const char *source)
{
    return make_job_of("\"sigma_s\": 8", source);
}

// Plans, which meets the light first.
static void assert_told(const char *source, const char *place)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    struct job job = make_job(source);
    enum renderer_fault fault = RENDERER_FAULT_NONE;
    struct error error = {{0}};
    struct plan plan;

    assert_false(plan_make(
        &plan, &(struct plan_params){.renderer = stage.renderer, .job = &job, .segment = plan_segment_at(&job, 0)},
        &fault, &error));
    assert_int_equal(fault, RENDERER_FAULT_JOB);
    if (!strstr(error.message, place)) fail_msg("expected %s, got %s", place, error.message);
    job_finish(&job);
    gl_stage_close(stage);
}

static void the_line_is_found(void **state)
{
    (void)state;
    assert_told("float density(vec3 p, float t) { return 1.0 / (length(p) * 0.0); }",
                "scene.media[0].density: density.source:1 ");
    assert_told("float none(float x)\\n{\\n    return x * 0.0;\\n}\\nfloat density(vec3 p, float t)\\n{\\n"
                "    vec3 q = p * 2.0;\\n    float far = 1.0 / none(q.x);\\n    float all = far + 1.0;\\n"
                "    return all;\\n}",
                "density.source:8 ");
}

// An array has no guard, so returns alone are tried.
static void other_types_leave_the_return(void **state)
{
    (void)state;
    assert_told("float density(vec3 p, float t)\\n{\\n    float[2] list = float[2](1.0, 2.0);\\n"
                "    float far = list[0] / (length(p) * 0.0);\\n    return far;\\n}",
                "density.source:5 ");
}

// Of a method that the job states, too, the first frame is not rendered whole: its march might never end.
static void stated_methods_look_first(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(test_shader_dir());
    struct job job = make_job("float density(vec3 p, float t) { return sqrt(p.x); }");

    (void)state;
    job.quality = (struct job_quality){
        .method = JOB_METHOD_ADAPTIVE, .step = 0.1, .light_step = 0.1, .depth_step = 0.1, .samples = 1, .max_cut = 1.0};
    for (int32_t frame = 0; frame < 2; frame++) {
        struct tolerance_result result;
        struct error error = {{0}};
        struct image image;

        assert_false(tolerance_stage_render(stage, &job, frame, &image, &result, &error));
        assert_int_equal(result.render.fault, RENDERER_FAULT_FRAME);
        if (!strstr(error.message, "density.source:1 gives a value that is not finite")) fail_msg("%s", error.message);
        image_finish(&image);
    }
    job_finish(&job);
    tolerance_stage_close(stage);
}

static bool on_no_audit(void *user, double done)
{
    (void)done;
    return *(enum frame_phase *)user != FRAME_PHASE_AUDIT;
}

static void on_phase(void *user, enum frame_phase phase)
{
    *(enum frame_phase *)user = phase;
}

// Renders a frame that fails before an audit begins, once.
static void assert_fails_at_once(struct tolerance_stage stage, const struct job *job, int32_t frame, const char *told)
{
    enum frame_phase phase = FRAME_PHASE_PLAN;
    struct image image = tolerance_stage_make_image(job);
    struct tolerance_result result;
    struct error error = {{0}};

    assert_false(tolerance_render(stage.tolerance,
                                  &(struct tolerance_params){.job = job,
                                                             .serial = 1,
                                                             .frame = frame,
                                                             .image = &image,
                                                             .on_progress = on_no_audit,
                                                             .on_phase = on_phase,
                                                             .user = &phase},
                                  &result, &error));
    print_message("%s\n", error.message);
    if (!strstr(error.message, told)) fail_msg("expected %s, got %s", told, error.message);
    assert_int_equal(result.render.fault, RENDERER_FAULT_FRAME);
    assert_int_equal(result.retry_count, 0);
    assert_int_equal(phase, FRAME_PHASE_RENDER);
    image_finish(&image);
}

static void assert_is_within(struct tolerance_stage stage, const struct job *job, int32_t frame)
{
    struct tolerance_result result;
    struct error error = {{0}};
    struct image image;

    if (!tolerance_stage_render(stage, job, frame, &image, &result, &error)) fail_msg("%s", error.message);
    assert_true(result.audit.error <= job->quality.tolerance);
    image_finish(&image);
}

// The pilot's frames know nothing of it.
static void light_that_ends_between_the_pilots_frames_is_told(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(test_shader_dir());
    struct job job = make_job("float density(vec3 p, float t)\\n{\\n"
                              "    float k = t > 0.2 && t < 0.3 ? sqrt(p.x) : 1.0;\\n    return k;\\n}");

    (void)state;
    job.quality.samples = 2;
    assert_fails_at_once(stage, &job, 6, "density.source:3 gives a value that is not finite (frame 6, pixel (");
    assert_is_within(stage, &job, 9);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// A half cannot hold it, a float can.
static void light_over_the_largest_half_is_told_as_such(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(test_shader_dir());
    struct job job = make_job_of("\"sigma_a\": 1, \"emission\": 1e6",
                                 "float density(vec3 p, float t) { return t > 0.2 && t < 0.3 ? 1.0 : 1e-3; }");

    (void)state;
    assert_fails_at_once(stage, &job, 6, "half holds at most 65504");
    job.output.pixel = JOB_PIXEL_FLOAT;
    assert_is_within(stage, &job, 6);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static void finite_pictures_pass(void **state)
{
    struct image image;
    size_t index;

    (void)state;
    assert_true(image_init(&image, 3, 2, false, false, NULL));
    for (size_t i = 0; i < 24; i++)
        image.rgba[i] = 1e38f / 4;
    assert_false(finite_check_find(&image, &index));
    image.rgba[4 * 4 + 1] = -1.0f / 0.0f;
    assert_true(finite_check_find(&image, &index));
    assert_int_equal(index, 4);
    image_finish(&image);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_line_is_found),
        cmocka_unit_test(other_types_leave_the_return),
        cmocka_unit_test(stated_methods_look_first),
        cmocka_unit_test(light_that_ends_between_the_pilots_frames_is_told),
        cmocka_unit_test(light_over_the_largest_half_is_told_as_such),
        cmocka_unit_test(finite_pictures_pass),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
