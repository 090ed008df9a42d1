// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/delete_parts.h"

#include "daemon/farm/job_table.h"
#include "tests/daemon/store/store_fixture.h"

enum { FRAMES = 50 * 1000 };

static struct queue *queue;
static struct job_table table;

// A job of which each frame has a row, in the table and in the store.
static struct job_record *add_job(struct store *store)
{
    static struct store_op rows[FRAMES];
    struct frame_range frames = {0};
    struct output_path path;
    struct job_record *record;

    assert_true(output_path_parse(&path, "a/c.#####.exr", NULL));
    assert_true(frame_range_parse(&frames, "1-50000", NULL));
    record = job_table_add(&table, 1, xstrdup("/films"), &path);
    record->name = xstrdup("ash");
    record->owner = xstrdup("ada");
    record->is_swept = true;
    record->finished_ms = 7;
    record->queued = queue_add_job(queue, &(struct queue_job_params){.id = 1, .frames = &frames, .priority = 50});
    commit_one(store, job_op(1));
    for (int i = 0; i < FRAMES; i++) {
        queue_restore_frame(record->queued, i, FRAME_SUCCEEDED, 1);
        rows[i] = frame_op(1, i, FRAME_SUCCEEDED);
    }
    assert_true(store_commit(store, rows, FRAMES, NULL));
    return record;
}

static int set_up(void **state)
{
    queue = queue_create(3);
    table = (struct job_table){0};
    return make_folder(state);
}

static int tear_down(void **state)
{
    job_table_finish(&table);
    queue_destroy(queue);
    return remove_folder(state);
}

// After each of its commits the process may be killed.
static void a_deletion_of_many_rows_leaves_a_canceled_job_until_its_end(void **state)
{
    struct store *store = open_store(*state);
    struct job_record *record = add_job(store);
    struct delete_parts parts = {0};
    int commits = 0, left = FRAMES;

    while (!parts.is_last) {
        struct store_op op = delete_parts_take(&parts, record, "ann");
        struct loaded loaded;

        assert_true(store_commit(store, &op, 1, NULL));
        store_op_finish(&op);
        loaded = load(store);
        assert_int_equal(loaded.jobs, parts.is_last ? 0 : 1);
        assert_true(left - loaded.frames <= 20000);
        left = loaded.frames;
        commits++;
        if (parts.is_last) break;
        assert_true(loaded.job.is_canceled);
        assert_int_equal(loaded.job.finished_ms, 7);
        assert_non_null(strstr(loaded.text, "its deletion by ann has begun: march delete 1 ends it"));
    }
    assert_int_equal(commits, 5);
    assert_int_equal(left, 0);
    store_close(store);
}

static void a_deletion_of_few_rows_is_one_commit(void **state)
{
    struct store *store = open_store(*state);
    struct job_record *record = add_job(store);
    struct delete_parts parts = {0};

    for (int i = 0; i < FRAMES - 20000; i++)
        queue_restore_frame(record->queued, i, FRAME_CANCELED, 1);
    assert_int_equal(delete_parts_take(&parts, record, "ann").kind, STORE_DELETE_JOB);
    assert_true(parts.is_last);
    store_close(store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_deletion_of_many_rows_leaves_a_canceled_job_until_its_end, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_deletion_of_few_rows_is_one_commit, set_up, tear_down),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
