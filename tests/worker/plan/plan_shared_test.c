// Plans that several workers share: what their frames follow from.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_shared.h"

#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "tests/support/tolerance_stage.h"
#include "worker/picture/image.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_lookup.h"
#include "worker/plan/plan_source.h"

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
    job.width_px = 32;
    job.height_px = 18;
    job.quality = (struct job_quality){
        .method = JOB_METHOD_AUTO, .tolerance = tolerance, .samples = 1, .max_depth = 8, .max_cut = 1.0};
    return job;
}

// Keeps the plans of one segment, as text.
struct keeper {
    const struct job *job;
    char key[HASH_TEXT_SIZE];
    char *text, *first; // owned
    int64_t number, missed;
    int made;
};

static void read_text(const struct keeper *keeper, const char *text, struct plan_json *plan)
{
    struct error error = {{0}};
    struct cJSON *tree = NULL;
    struct json_node root;

    assert_true(json_parse(&tree, text, strlen(text), &error));
    root = json_node_root(tree);
    if (!plan_from_json(plan, &root, keeper->job, &error)) fail_msg("%s", error.message);
    json_delete(tree);
}

static enum plan_source_answer find(void *user, const char *key, int64_t *number, struct plan_json *plan,
                                    struct error *error)
{
    struct keeper *keeper = user;

    if (!keeper->key[0]) memcpy(keeper->key, key, HASH_TEXT_SIZE);
    assert_string_equal(keeper->key, key);
    if (keeper->number == 0) return PLAN_SOURCE_MAKE;
    if (*number != keeper->number) read_text(keeper, keeper->text, plan);
    *number = keeper->number;
    return PLAN_SOURCE_HAS;
}

static enum plan_source_answer keep(void *user, const char *key, int64_t missed, const struct plan_json *plan,
                                    int64_t *number, struct error *error)
{
    struct keeper *keeper = user;
    struct json_writer writer = {0};

    assert_string_equal(keeper->key, key);
    plan_to_json(&writer, plan, keeper->job);
    free(keeper->first);
    keeper->first = keeper->text;
    keeper->text = writer.text;
    keeper->missed = missed;
    keeper->made++;
    *number = ++keeper->number;
    return PLAN_SOURCE_HAS;
}

struct drawn {
    struct image image; // owned
    struct tolerance_result result;
};

static struct drawn draw(struct tolerance_stage stage, struct keeper *keeper, int32_t frame, enum plan_choice choice)
{
    const struct plan_source source = {.find = find, .keep = keep, .user = keeper};
    struct drawn drawn = {.image = tolerance_stage_make_image(keeper->job)};
    struct error error = {{0}};

    if (!tolerance_render(stage.tolerance,
                          &(struct tolerance_params){.job = keeper->job,
                                                     .serial = 1,
                                                     .frame = frame,
                                                     .image = &drawn.image,
                                                     .choice = choice,
                                                     .source = &source},
                          &drawn.result, &error))
        fail_msg("%s", error.message);
    return drawn;
}

static void assert_same(const struct drawn *a, const struct drawn *b)
{
    const struct audit_result *one = &a->result.audit, *other = &b->result.audit;

    assert_memory_equal(a->image.rgba, b->image.rgba, 16 * (size_t)a->image.width_px * (size_t)a->image.height_px);
    assert_true(one->error == other->error && one->error95 == other->error95);
    assert_true(one->ray_count == other->ray_count && one->is_pooled == other->is_pooled);
    assert_int_equal(a->result.plan_number, b->result.plan_number);
}

// One worker makes the plan and renders other frames before; the other is given the plan.
static void workers_that_share_a_plan_make_equal_frames(void **state)
{
    struct tolerance_stage first = tolerance_stage_open(NULL), second = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.05);
    struct keeper keeper = {.job = &job};
    static const int32_t frames[] = {11, 40, 23, 0};

    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        struct drawn one = draw(first, &keeper, frames[i], PLAN_CHOICE_CHEAPEST);
        // The other way round.
        struct drawn other = i == 3 ? draw(second, &keeper, frames[i], PLAN_CHOICE_CHEAPEST) : (struct drawn){0};

        assert_int_equal(one.result.plan_number, 1);
        assert_int_equal(one.result.retry_count, 0);
        if (i == 3) assert_same(&one, &other);
        image_finish(&other.image);
        image_finish(&one.image);
    }
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        struct drawn one = draw(first, &keeper, frames[i], PLAN_CHOICE_CHEAPEST);
        struct drawn other = draw(second, &keeper, frames[i], PLAN_CHOICE_CHEAPEST);

        assert_same(&one, &other);
        image_finish(&other.image);
        image_finish(&one.image);
    }
    assert_int_equal(keeper.made, 1);
    free(keeper.text);
    free(keeper.first);
    job_finish(&job);
    tolerance_stage_close(second);
    tolerance_stage_close(first);
}

// The frame itself follows from the plan with which it began, whoever renders it.
static void a_miss_makes_the_next_number(void **state)
{
    struct tolerance_stage first = tolerance_stage_open(NULL), second = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.02);
    struct keeper keeper = {.job = &job}, before = {.job = &job, .number = 1};
    struct drawn missed = draw(first, &keeper, 3, PLAN_CHOICE_COARSEST), again, later;

    assert_true(missed.result.retry_count > 0);
    assert_int_equal(missed.result.plan_number, 1);
    assert_int_equal(keeper.made, 2);
    assert_int_equal(keeper.missed, 1);
    before.text = keeper.first;
    keeper.first = NULL;
    again = draw(second, &before, 3, PLAN_CHOICE_COARSEST);
    assert_same(&missed, &again);
    assert_string_equal(before.text, keeper.text);
    later = draw(first, &keeper, 45, PLAN_CHOICE_COARSEST);
    assert_int_equal(later.result.retry_count, 0);
    assert_int_equal(later.result.plan_number, 2);
    assert_int_equal(keeper.made, 2);
    image_finish(&missed.image);
    image_finish(&again.image);
    image_finish(&later.image);
    free(before.first);
    free(before.text);
    free(keeper.text);
    job_finish(&job);
    tolerance_stage_close(second);
    tolerance_stage_close(first);
}

static void stated_settings_make_the_same_frame(void **state)
{
    struct tolerance_stage first = tolerance_stage_open(NULL), second = tolerance_stage_open(NULL);
    struct job job = cloud_job(0.02);
    struct keeper keeper = {.job = &job};
    struct drawn drawn = draw(first, &keeper, 3, PLAN_CHOICE_COARSEST);
    struct image image = tolerance_stage_make_image(&job);
    struct plan_json coarsest;
    struct tolerance_params params = {
        .job = &job, .serial = 1, .frame = 3, .image = &image, .repeated = &drawn.result.quality, .repeated_number = 2};
    struct tolerance_result result;
    struct error error = {{0}};

    if (!tolerance_render(second.tolerance, &params, &result, &error)) fail_msg("%s", error.message);
    assert_memory_equal(drawn.image.rgba, image.rgba, 16 * 32 * 18);
    assert_int_equal(result.plan_number, 2);
    assert_int_equal(result.retry_count, 0);
    assert_false(result.audit.is_missed);
    // A setting that misses is not tried again, and says so.
    read_text(&keeper, keeper.first, &coarsest);
    params.repeated = &coarsest.quality;
    assert_true(tolerance_render(second.tolerance, &params, &result, NULL));
    assert_true(result.audit.is_missed && result.retry_count == 0 && result.audit.error > 0.02);
    // An error within the tolerance by less than its standard error is no miss, as where misses are published.
    for (int i = 0; i < 3; i++) {
        job.quality.tolerance = coarsest.quality.tolerance = result.audit.error + 0.5 * result.audit.spread;
        assert_true(tolerance_render(second.tolerance, &params, &result, NULL));
    }
    assert_true(result.audit.error + result.audit.spread > job.quality.tolerance);
    assert_true(!result.audit.is_missed && result.audit.error <= job.quality.tolerance);
    // One that no plan chooses has nothing to be compared with.
    coarsest.quality.step *= 1.1;
    assert_false(tolerance_render(second.tolerance, &params, &result, NULL));
    assert_int_equal(result.render.fault, RENDERER_FAULT_JOB);
    image_finish(&image);
    image_finish(&drawn.image);
    free(keeper.text);
    free(keeper.first);
    job_finish(&job);
    tolerance_stage_close(second);
    tolerance_stage_close(first);
}

// The audit of a copy is that of the same frame rendered alone.
static void a_copy_has_the_audit_that_it_would_have_alone(void **state)
{
    struct tolerance_stage first = tolerance_stage_open(NULL), second = tolerance_stage_open(NULL);
    struct keeper keeper = {0};
    struct drawn original, copy, alone;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", \"quality\": {\"tolerance\": 0.02}");
    keeper.job = &job;
    original = draw(first, &keeper, 0, PLAN_CHOICE_CHEAPEST);
    copy = draw(first, &keeper, 1, PLAN_CHOICE_CHEAPEST);
    alone = draw(second, &keeper, 1, PLAN_CHOICE_CHEAPEST);
    assert_true(copy.result.render.is_copy && !alone.result.render.is_copy);
    assert_same(&copy, &alone);
    image_finish(&original.image);
    image_finish(&copy.image);
    image_finish(&alone.image);
    free(keeper.text);
    free(keeper.first);
    job_finish(&job);
    tolerance_stage_close(second);
    tolerance_stage_close(first);
}

static void find_key(struct tolerance_stage stage, struct job *job, const char *frames, int32_t frame,
                     char key[static HASH_TEXT_SIZE])
{
    frame_range_finish(&job->frames);
    assert_true(frame_range_parse(&job->frames, frames, NULL));
    plan_shared_find_key(
        &(struct plan_params){.renderer = stage.gl.renderer, .job = job, .segment = plan_segment_of(job, frame)}, key);
}

static void equal_segments_of_equal_pictures_have_one_key(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    char key[HASH_TEXT_SIZE], other[HASH_TEXT_SIZE];
    struct job job = cloud_job(0.05);

    find_key(stage, &job, "0-95", 50, key);
    find_key(stage, &job, "48-95", 90, other);
    assert_string_equal(key, other);
    find_key(stage, &job, "0-95", 47, other);
    assert_string_not_equal(key, other);
    find_key(stage, &job, "48-94", 50, other);
    assert_string_not_equal(key, other);
    job.hash[0] ^= 1;
    find_key(stage, &job, "0-95", 50, other);
    assert_string_not_equal(key, other);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static void an_adopted_plan_refines_the_same_frames(void **state)
{
    struct job job = cloud_job(0.05);
    struct plan plan = {.point = {.rungs = {6, 6, 6}},
                        .scouting = {.count = 3, .last = 47, .error = {0.001, 0.2, 0.001}},
                        .reason = "so"};
    struct plan_evidence evidence = {.pixel_limit = 576}, adopted_evidence = {0};
    const struct plan_params params = {.job = &job, .segment = plan_segment_of(&job, 0)};
    struct plan_json shared;
    struct plan adopted, refined, adopted_refined;
    enum renderer_fault fault;
    struct plan_scene scene;

    plan_scene_init(&scene, &job);
    while (!plan_family_serves(&plan_families[plan.family], &scene))
        plan.family++;
    plan.quality = plan_family_quality(&plan_families[plan.family], &scene, &plan.point);
    evidence.finest = plan.quality;
    plan_shared_describe(&shared, &plan, &evidence, &job);
    assert_true(plan_shared_adopt(&adopted, &adopted_evidence, &shared, &params, &fault, NULL));
    assert_string_equal(adopted.reason, "so");
    refined = plan_of_frame(&plan, &job, 23);
    adopted_refined = plan_of_frame(&adopted, &job, 23);
    assert_true(refined.quality.step < plan.quality.step);
    assert_true(adopted_refined.quality.step == refined.quality.step);
    refined = plan_of_frame(&adopted, &job, 0);
    assert_true(refined.quality.step == plan.quality.step);
    plan_evidence_finish(&adopted_evidence);
    job_finish(&job);
}

// Settings alone name their point: what is refined from them is the same everywhere.
static void settings_are_found_again(void **state)
{
    static const char *const names[] = {"cloud", "noise", "fog", "glass"};

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct plan_scene scene;
        struct job job;

        example_job_load(&job, names[i]);
        job.quality.method = JOB_METHOD_AUTO;
        plan_scene_init(&scene, &job);
        for (size_t family = 0; family < plan_family_count; family++) {
            struct plan_point point = {.rungs = {7, 3, 5, 2, 1}}, found_point;
            struct job_quality quality, found;
            size_t found_family;

            if (!plan_family_serves(&plan_families[family], &scene)) continue;
            quality = plan_family_quality(&plan_families[family], &scene, &point);
            assert_true(plan_lookup(&scene, &quality, &found_family, &found_point));
            found = plan_family_quality(&plan_families[found_family], &scene, &found_point);
            assert_memory_equal(&quality, &found, sizeof quality);
            quality.samples++;
            assert_false(plan_lookup(&scene, &quality, &found_family, &found_point));
        }
        job_finish(&job);
    }
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(workers_that_share_a_plan_make_equal_frames),
        cmocka_unit_test(a_miss_makes_the_next_number),
        cmocka_unit_test(stated_settings_make_the_same_frame),
        cmocka_unit_test(a_copy_has_the_audit_that_it_would_have_alone),
        cmocka_unit_test(equal_segments_of_equal_pictures_have_one_key),
        cmocka_unit_test(an_adopted_plan_refines_the_same_frames),
        cmocka_unit_test(settings_are_found_again),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
