// SPDX-License-Identifier: Apache-2.0
#include "core/job/plan_json.h"

#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "tests/support/job_expect.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char whole[] =
    "{\"quality\":{\"method\":\"midpoint\",\"step\":0.25,\"light_step\":0.5,\"samples\":4},\"why\":\"so\","
    "\"before\":{\"quality\":{\"method\":\"midpoint\",\"step\":0.5,\"light_step\":1,\"samples\":4}},"
    "\"scouts\":[0.5,0.25],\"scattered\":[0.25,0.125],\"pilot\":{\"quality\":{\"method\":\"midpoint\",\"step\":0.125,"
    "\"light_step\":0.25,"
    "\"samples\":4},\"pixels\":576,\"frames\":[1,3],\"change\":0.125,\"samples\":[[1,-2,0.1],[3,4,5]]},"
    "\"beyond\":{\"error\":0.5,\"error95\":0.625}}";

// A job that states a tolerance, with 4 samples.
static struct job tolerant_job(void)
{
    char *text = json_edit_set(job_text_noise, "quality", "{\"tolerance\":0.02,\"samples\":4,\"on_miss\":\"publish\"}");
    struct job job = job_expect(text);

    free(text);
    return job;
}

static bool read(const char *text, const struct job *job, struct plan_json *plan, struct error *error)
{
    struct cJSON *tree = NULL;
    struct json_node root;
    bool ok;

    assert_true(json_parse(&tree, text, strlen(text), NULL));
    root = json_node_root(tree);
    ok = plan_from_json(plan, &root, job, error);
    json_delete(tree);
    return ok;
}

static void a_plan_is_read_and_written(void **state)
{
    struct job job = tolerant_job();
    struct json_writer writer = {0}, other = {0};
    struct plan_json plan, again;
    struct error error = {{0}};

    if (!read(whole, &job, &plan, &error)) fail_msg("%s", error.message);
    assert_int_equal(plan.quality.method, JOB_METHOD_MIDPOINT);
    assert_true(plan.quality.step == 0.25 && plan.view_quality.step == 0.125);
    assert_true(plan.quality.tolerance == 0.02 && plan.quality.on_miss == JOB_ON_MISS_PUBLISH);
    assert_true(plan.quality.max_depth == job.quality.max_depth && plan.quality.max_cut == 1.0);
    assert_true(plan.has_before && plan.before.step == 0.5 && plan.before.tolerance == 0.02);
    assert_int_equal(plan.scout_count, 2);
    assert_true(plan.cells_square == 0.25 && plan.paths_square == 0.125);
    assert_int_equal(plan.view_count, 2);
    assert_int_equal(plan.view_frames[1], 3);
    assert_int_equal(plan.view_pixels, 576);
    assert_int_equal(plan.sample_count, 2);
    assert_true(plan.samples[0][1] == -2.0 && plan.samples[0][2] == 0.1 && plan.sample_change == 0.125);
    assert_true(plan.beyond.is_known && plan.beyond.error == 0.5 && plan.beyond.error95 == 0.625);
    // An error that is not finite stays a large one.
    plan.scout_errors[1] = INFINITY;
    plan_to_json(&writer, &plan, &job);
    if (!read(writer.text, &job, &again, &error)) fail_msg("%s", error.message);
    assert_true(again.scout_errors[0] == 0.5 && again.scout_errors[1] == 1e300);
    plan_to_json(&other, &again, &job);
    assert_string_equal(writer.text, other.text);
    assert_true(again.cells_square == 0.25 && again.paths_square == 0.125);
    json_writer_finish(&writer);
    json_writer_finish(&other);
    job_finish(&job);
}

// What a stranger could send in place of a plan.
static struct plan_json read_quality(const char *quality, const struct job *job)
{
    char *text = json_edit_set(whole, "quality", quality);
    struct plan_json plan;
    struct error error = {{0}};

    if (!read(text, job, &plan, &error)) fail_msg("%s", error.message);
    free(text);
    return plan;
}

// Random paths have no limits of rays, so their plans do not tell them: those of the job are theirs.
static void limits_of_rays_that_a_plan_does_not_tell_are_the_jobs(void **state)
{
    char *text = json_edit_set(
        job_text_noise, "scene.objects",
        "[{\"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": 1}}]");
    char *limited =
        json_edit_set(text, "quality", "{\"tolerance\":0.02,\"samples\":4,\"max_depth\":4,\"min_throughput\":0.25}");
    struct job job = job_expect(limited);
    struct plan_json plan = read_quality("{\"method\":\"paths\",\"paths\":64,\"samples\":4}", &job);

    (void)state;
    assert_true(plan.quality.max_depth == 4 && plan.quality.min_throughput == 0.25);
    plan = read_quality("{\"method\":\"midpoint\",\"step\":0.5,\"light_step\":0.5,\"samples\":4}", &job);
    assert_int_equal(plan.quality.max_depth, JOB_DEPTH_DEFAULT);
    job_finish(&job);
    free(limited);
    free(text);
}

static void other_plans_are_refused(void **state)
{
    static const struct {
        const char *path, *value, *message;
    } cases[] = {
        {"quality", "{\"tolerance\":0.5,\"samples\":4}", "quality: expected a quality with a method"},
        {"quality", "\"draft\"", "quality: expected an object"},
        {"quality.step", "0", "quality.step: expected"},
        {"quality.step", "-1", "quality.step: expected"},
        {"quality.samples", "1024", "quality.samples: expected as many as the job has"},
        {"quality.max_depth", "1000", "quality.max_depth: expected"},
        {"quality.light_grid", "4", "quality: unknown key \"light_grid\""},
        {"why", "7", "why: expected"},
        {"before", "7", "before: expected an object"},
        {"before.more", "1", "before: unknown key"},
        {"before.quality.step", "-1", "before.quality.step: expected"},
        {"scouts", "[-1]", "scouts[0]: expected"},
        {"scattered", "[1,-1]", "scattered[1]: expected"},
        {"scattered", "[1]", "scattered: expected"},
        {"scouts", "[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0]", "scouts: expected"},
        {"pilot.pixels", "5000", "pilot.pixels: expected"},
        {"pilot.frames", "[999999]", "pilot.frames[0]: expected a frame of the job"},
        {"pilot.frames", "[1,2,3,4]", "pilot.frames: expected"},
        {"pilot.samples", "[[1,2]]", "pilot.samples[0]: expected"},
        {"pilot.quality.method", "\"auto\"", "pilot.quality"},
        {"pilot.more", "1", "pilot: unknown key"},
        {"beyond", "1", "beyond: expected an object"},
        {"beyond.error95", "0.25", "beyond.error95: expected"},
        {"more", "1", "unknown key"},
    };
    struct job job = tolerant_job();

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *text = json_edit_set(whole, cases[i].path, cases[i].value);
        struct error error = {{0}};
        struct plan_json plan;

        assert_false(read(text, &job, &plan, &error));
        if (strncmp(error.message, cases[i].message, strlen(cases[i].message)) != 0)
            fail_msg("%s = %s: %s", cases[i].path, cases[i].value, error.message);
        free(text);
    }
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plan_is_read_and_written),
        cmocka_unit_test(limits_of_rays_that_a_plan_does_not_tell_are_the_jobs),
        cmocka_unit_test(other_plans_are_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
