// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/draft.h"

#include "core/base/error.h"
#include "core/job/step_check.h"
#include "core/json/json_read.h"
#include "tests/support/example_job.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const char *const examples[] = {"cloud", "noise",  "smoke", "fog",    "sunset",      "custom",
                                       "glass", "opaque", "scan",  "mirror", "translucent", "globe"};
enum { COUNT = sizeof examples / sizeof *examples };
static const double COARSEST = 0.0624; // of the longest path: a sixteenth, rounded down

static void load(struct job *job, const char *name)
{
    example_job_load(job, name);
    job->width_px = 640;
    job->height_px = 360;
    job->quality = (struct job_quality){
        .method = JOB_METHOD_DRAFT, .is_draft = true, .samples = 1, .max_depth = 8, .min_throughput = 1e-3};
}

static struct draft choose(const struct job *job)
{
    struct error error = {{0}};
    struct draft draft;

    if (!draft_choose(&draft, job, &error)) fail_msg("%s", error.message);
    return draft;
}

static void every_example_has_a_draft_within_the_count(void **state)
{
    struct json_node nowhere = json_node_root(NULL);
    struct job job;

    for (size_t i = 0; i < COUNT; i++) {
        struct draft draft;
        struct error error = {{0}};

        load(&job, examples[i]);
        draft = choose(&job);
        assert_true(job_quality_states_method(&draft.quality));
        assert_true(draft.quality.is_draft && draft.quality.max_cut == 1.0 && draft.quality.tolerance == 0.0);
        if (draft.evaluations > DRAFT_EVALUATIONS && draft.quality.step < COARSEST * step_longest_path(&job))
            fail_msg("%s: %g evaluations", examples[i], draft.evaluations);
        job.quality = draft.quality;
        assert_true(draft_count(&job) == draft.evaluations);
        if (!step_check(&job, &nowhere, &error)) fail_msg("%s: %s", examples[i], error.message);
        job_finish(&job);
    }
}

static void the_count_is_used(void **state)
{
    struct job job;
    struct draft draft;

    load(&job, "cloud");
    draft = choose(&job);
    assert_int_equal(draft.quality.method, JOB_METHOD_CACHED);
    assert_true(draft.evaluations > DRAFT_EVALUATIONS / 3.0);
    job_finish(&job);
}

// The mist of globe reaches 60 m; the smoke in its ball of glass is 1.8 m wide.
static void small_media_in_wide_scenes_are_resolved(void **state)
{
    struct job job;

    load(&job, "globe");
    assert_true(choose(&job).quality.step < 0.25);
    job_finish(&job);
}

static void the_method_with_the_least_work_is_taken(void **state)
{
    struct job job;
    struct draft draft;

    load(&job, "fog");
    draft = choose(&job);
    assert_int_equal(draft.option_count, 1);
    assert_string_equal(draft.options[0].name, "equiangular");
    job_finish(&job);
    load(&job, "cloud");
    draft = choose(&job);
    assert_true(draft.option_count > 2);
    for (size_t i = 1; i < draft.option_count; i++)
        assert_true(draft.options[i - 1].evaluations <= draft.options[i].evaluations);
    job_finish(&job);
}

// Cells of a light's grid cost as much in a small picture as in a large one.
static void a_small_picture_has_coarser_grids(void **state)
{
    struct job job;
    int large;

    load(&job, "cloud");
    large = choose(&job).quality.light_grid;
    job.width_px = 64;
    job.height_px = 36;
    assert_true(choose(&job).quality.light_grid < large);
    job_finish(&job);
}

static void only_drafts_are_settled(void **state)
{
    char reason[IMAGE_EXR_PLAN_SIZE] = "";
    struct job job;
    char hash[HASH_TEXT_SIZE];

    load(&job, "cloud");
    memcpy(hash, job.hash, sizeof hash);
    assert_true(draft_settle(&job, reason, NULL));
    assert_int_equal(job.quality.method, JOB_METHOD_CACHED);
    assert_memory_equal(reason, "a draft: cached ", strlen("a draft: cached "));
    assert_string_equal(job.hash, hash);
    job.quality = (struct job_quality){.method = JOB_METHOD_AUTO, .tolerance = 0.01};
    assert_true(draft_settle(&job, reason, NULL));
    assert_int_equal(job.quality.method, JOB_METHOD_AUTO);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_example_has_a_draft_within_the_count),
        cmocka_unit_test(the_count_is_used),
        cmocka_unit_test(small_media_in_wide_scenes_are_resolved),
        cmocka_unit_test(the_method_with_the_least_work_is_taken),
        cmocka_unit_test(a_small_picture_has_coarser_grids),
        cmocka_unit_test(only_drafts_are_settled),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
