// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/job_fence.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/path_list.h"
#include "core/job/job.h"
#include "core/json/json_write.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { ANN = 1000, BOB = 1001 };

// A farm whose jobs are queued in the order of their ids.
struct stage {
    struct options options;
    struct farm farm;
    struct job_fence_files asked;
    int64_t id;
};

static struct stage *stage_create(void)
{
    struct stage *stage = xcalloc(1, sizeof *stage);

    stage->options.state_folder = xstrdup("/state");
    stage->options.socket_path = xstrdup("/socket");
    path_list_add(&stage->options.input_roots, xstrdup("/in"));
    stage->farm.options = &stage->options;
    stage->farm.queue = queue_create(3);
    return stage;
}

static void stage_destroy(struct stage *stage)
{
    job_fence_files_finish(&stage->asked);
    queue_destroy(stage->farm.queue);
    job_table_finish(&stage->farm.jobs);
    root_table_finish(&stage->farm.roots);
    path_list_finish(&stage->options.input_roots);
    free(stage->options.state_folder);
    free(stage->options.socket_path);
    free(stage);
}

// Adds a job of that user; `file` NULL: it reads none.
static struct job_record *add_job(struct stage *stage, int64_t owner_uid, const char *file, const char *folder)
{
    char *pattern = xasprintf("%s%sf.####.exr", folder, *folder ? "/" : "");
    struct frame_range frames;
    struct output_path path;
    struct job_record *record;

    stage->id++;
    assert_true(output_path_parse(&path, pattern, NULL));
    assert_true(frame_range_parse(&frames, "1-2", NULL));
    record = job_table_add(&stage->farm.jobs, stage->id, xstrdup("/out"), &path);
    record->output_root = root_table_add(&stage->farm.roots, "/out");
    record->owner_uid = owner_uid;
    if (file) {
        struct job job = {.scene = {.medium_count = 1}};

        job.scene.media[0].density.kind = SCENE_DENSITY_GRID;
        job.scene.media[0].density.grid.file = (char *)file;
        job_paths_list(&record->inputs, &job);
    }
    record->queued = queue_add_job(stage->farm.queue,
                                   &(struct queue_job_params){.id = stage->id, .frames = &frames, .priority = 50});
    free(pattern);
    return record;
}

static struct job_fence *fence_of(struct stage *stage, const struct job_record *record)
{
    struct error error = {0};
    struct job_fence *fence = job_fence_create(&stage->farm, record, &error);

    if (!fence) fail_msg("%s", error.message);
    return fence;
}

static bool opens(struct stage *stage, const struct job_fence *fence, const struct job_record *record)
{
    return job_fence_opens(fence, &stage->farm, record, &stage->asked);
}

// Whether the message worker.fence has the text.
static bool has_text(struct stage *stage, const struct job_fence *fence, const char *text)
{
    struct json_writer writer = {0};
    bool has;

    job_fence_write(fence, &stage->farm, &writer);
    has = strstr(writer.text, text) != NULL;
    json_writer_finish(&writer);
    return has;
}

static void next_jobs_of_the_owner_are_in_the_fence(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *own = add_job(stage, ANN, "/in/ann/a.nvdb", "ann/one");
    struct job_record *next = add_job(stage, ANN, "/in/more/a.nvdb", "ann/two");
    struct job_fence *fence = fence_of(stage, own);
    struct job_record *late = add_job(stage, ANN, NULL, "ann/three");

    assert_true(has_text(stage, fence, "\"output\":{\"root\":\"/out\",\"root_id\":\"\",\"folder\":\"ann/one\"}"));
    assert_true(has_text(stage, fence, "\"output\":{\"root\":\"/out\",\"root_id\":\"\",\"folder\":\"ann/two\"}"));
    assert_true(has_text(stage, fence, "/in/more/a.nvdb"));
    assert_true(opens(stage, fence, next));
    assert_false(opens(stage, fence, late)); // nothing was known of its folder
    job_fence_destroy(fence);
    stage_destroy(stage);
}

static void jobs_of_others_are_not(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *own = add_job(stage, ANN, "/in/shared/a.nvdb", "ann");
    struct job_record *bobs = add_job(stage, BOB, "/in/shared/a.nvdb", "bob"), *last, *inside;
    struct job_fence *fence;

    for (int i = 0; i < 64; i++) // they do not take the places of ann's either
        add_job(stage, BOB, NULL, "bob");
    last = add_job(stage, ANN, NULL, "last");
    fence = fence_of(stage, own);
    inside = add_job(stage, BOB, NULL, "ann");
    assert_false(has_text(stage, fence, "bob"));
    assert_false(opens(stage, fence, bobs));
    assert_true(opens(stage, fence, last));
    assert_false(opens(stage, fence, inside)); // nobody was told of it
    job_fence_destroy(fence);
    stage_destroy(stage);
}

static void folders_that_others_use_are_for_one_job(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *bobs = add_job(stage, BOB, NULL, "film/bob"), *own = add_job(stage, ANN, NULL, "ann");
    struct job_record *shared = add_job(stage, ANN, NULL, "film"), *next = add_job(stage, ANN, NULL, "next");
    struct job_fence *plain = fence_of(stage, own), *alone = fence_of(stage, shared);

    assert_false(has_text(stage, plain, "\"film\""));
    assert_false(job_fence_is_shared(plain));
    assert_true(opens(stage, plain, next));
    assert_true(has_text(stage, alone, "\"others\":[]"));
    assert_true(job_fence_is_shared(alone));
    assert_false(opens(stage, alone, next));
    // A job that is over may have left pictures.
    queue_cancel(stage->farm.queue, bobs->queued);
    job_fence_destroy(alone);
    alone = fence_of(stage, shared);
    assert_true(job_fence_is_shared(alone));
    job_fence_destroy(alone);
    job_fence_destroy(plain);
    stage_destroy(stage);
}

static void others_jobs_end_what_a_fence_opens(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *own = add_job(stage, ANN, NULL, "ann"), *next = add_job(stage, ANN, NULL, "next");
    struct job_fence *fence = fence_of(stage, own);

    assert_false(job_fence_note_job(fence, add_job(stage, ANN, NULL, "next/deep")));
    assert_false(job_fence_note_job(fence, add_job(stage, BOB, NULL, "nextdoor")));
    assert_true(opens(stage, fence, next));
    assert_true(job_fence_note_job(fence, add_job(stage, BOB, NULL, "next/bob")));
    assert_false(opens(stage, fence, next));
    job_fence_destroy(fence);
    stage_destroy(stage);
}

static void jobs_that_do_not_come_next_are_not(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *before = add_job(stage, ANN, NULL, "before");
    struct job_record *own = add_job(stage, ANN, NULL, "own"), *paused = add_job(stage, ANN, NULL, "paused");
    struct job_record *over = add_job(stage, ANN, NULL, "over"), *alone = add_job(stage, ANN, NULL, "alone");
    struct job_fence *fence;

    queue_pause(stage->farm.queue, paused->queued);
    queue_cancel(stage->farm.queue, over->queued);
    alone->needs_own_worker = true;
    fence = fence_of(stage, own);
    assert_false(opens(stage, fence, before));
    assert_false(has_text(stage, fence, "paused"));
    assert_false(has_text(stage, fence, "over"));
    assert_false(has_text(stage, fence, "alone"));
    job_fence_destroy(fence);
    stage_destroy(stage);
}

static void fence_opens_what_lies_in_its_folders(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *own = add_job(stage, ANN, "/in/ann/a.nvdb", "ann");
    struct job_fence *fence = fence_of(stage, own);

    assert_true(opens(stage, fence, add_job(stage, ANN, "/in/ann/b.nvdb", "ann")));
    assert_true(opens(stage, fence, add_job(stage, ANN, "/in/ann/deep/b.nvdb", "ann/deep")));
    assert_true(opens(stage, fence, add_job(stage, ANN, NULL, "ann/deep")));
    assert_false(opens(stage, fence, add_job(stage, ANN, NULL, "anna")));
    assert_false(opens(stage, fence, add_job(stage, ANN, NULL, "")));
    assert_false(opens(stage, fence, add_job(stage, ANN, "/in/anna/b.nvdb", "ann")));
    assert_false(opens(stage, fence, add_job(stage, ANN, "/in/b.nvdb", "ann")));
    job_fence_destroy(fence);
    stage_destroy(stage);
}

// In the root itself no folder is opened, only the job's own file.
static void root_is_not_opened_for_its_files(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *own = add_job(stage, ANN, "/in/a.nvdb", "ann");
    struct job_fence *fence = fence_of(stage, own);

    assert_true(opens(stage, fence, add_job(stage, ANN, "/in/a.nvdb", "ann")));
    assert_false(opens(stage, fence, add_job(stage, ANN, "/in/b.nvdb", "ann")));
    assert_false(opens(stage, fence, add_job(stage, ANN, "/in/ann/b.nvdb", "ann")));
    job_fence_destroy(fence);
    stage_destroy(stage);
}

static void jobs_with_the_converter_are_alone(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *first = add_job(stage, ANN, "/in/ann/a.nvdb", "ann");
    struct job_record *second = add_job(stage, ANN, "/in/ann/a.vdb", "ann");
    struct job_record *third = add_job(stage, ANN, "/in/ann/a.nvdb", "ann");
    struct job_fence *plain = fence_of(stage, first), *converting = fence_of(stage, second);

    assert_true(has_text(stage, plain, "\"converter\":false"));
    assert_false(has_text(stage, plain, "a.vdb"));
    assert_false(opens(stage, plain, second));
    assert_true(has_text(stage, converting, "\"converter\":true"));
    assert_true(has_text(stage, converting, "\"others\":[]"));
    assert_false(opens(stage, converting, third));
    job_fence_destroy(plain);
    job_fence_destroy(converting);
    stage_destroy(stage);
}

static void fence_of_former_roots_opens_nothing_more(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *own = add_job(stage, ANN, "/in/ann/a.nvdb", "ann");
    struct job_fence *fence = fence_of(stage, own);
    struct job_record *next = add_job(stage, ANN, NULL, "ann");

    assert_true(opens(stage, fence, next));
    path_list_finish(&stage->options.input_roots);
    path_list_add(&stage->options.input_roots, xstrdup("/in/bob"));
    assert_false(opens(stage, fence, next));
    job_fence_destroy(fence);
    stage_destroy(stage);
}

static void fence_has_64_jobs_at_most(void **state)
{
    struct stage *stage = stage_create();
    struct job_record *own = add_job(stage, ANN, NULL, "f0"), *last = NULL;
    struct job_fence *fence;

    for (int i = 1; i <= 64; i++) {
        char folder[8];

        snprintf(folder, sizeof folder, "f%d", i);
        last = add_job(stage, ANN, NULL, folder);
    }
    fence = fence_of(stage, own);
    assert_true(has_text(stage, fence, "\"f63\""));
    assert_false(has_text(stage, fence, "\"f64\""));
    assert_false(opens(stage, fence, last));
    job_fence_destroy(fence);
    stage_destroy(stage);
}

static void job_without_a_root_has_no_fence(void **state)
{
    struct stage *stage = stage_create();
    struct error error = {0};

    assert_null(job_fence_create(&stage->farm, add_job(stage, ANN, "/etc/a.nvdb", "ann"), &error));
    assert_non_null(strstr(error.message, "expected a file below /in"));
    stage_destroy(stage);
}

static void fence_is_old_when_its_output_root_is_another_place(void **state)
{
    struct stage *stage = stage_create();
    const struct job_record *record = add_job(stage, ANN, NULL, "a");
    struct root_place place = {.device = 1, .inode = 2, .mount = 3};
    struct job_fence *fence;

    root_set_place(record->output_root, &place);
    fence = fence_of(stage, record);
    root_set_trouble(record->output_root, "unmounted");
    assert_false(job_fence_is_old(fence));
    root_set_place(record->output_root, &place);
    assert_false(job_fence_is_old(fence));
    place.mount++;
    root_set_place(record->output_root, &place);
    assert_true(job_fence_is_old(fence));
    job_fence_destroy(fence);
    stage_destroy(stage);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(next_jobs_of_the_owner_are_in_the_fence),
        cmocka_unit_test(jobs_of_others_are_not),
        cmocka_unit_test(folders_that_others_use_are_for_one_job),
        cmocka_unit_test(others_jobs_end_what_a_fence_opens),
        cmocka_unit_test(jobs_that_do_not_come_next_are_not),
        cmocka_unit_test(fence_opens_what_lies_in_its_folders),
        cmocka_unit_test(root_is_not_opened_for_its_files),
        cmocka_unit_test(jobs_with_the_converter_are_alone),
        cmocka_unit_test(fence_of_former_roots_opens_nothing_more),
        cmocka_unit_test(fence_has_64_jobs_at_most),
        cmocka_unit_test(job_without_a_root_has_no_fence),
        cmocka_unit_test(fence_is_old_when_its_output_root_is_another_place),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
