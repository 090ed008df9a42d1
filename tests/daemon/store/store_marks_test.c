// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_marks.h"

#include "tests/daemon/store/store_fixture.h"

#include <sqlite3.h>
#include <sys/stat.h>

static struct queue_job *add_job(struct queue *queue, const char *frames)
{
    struct frame_range range;

    assert_true(frame_range_parse(&range, frames, NULL));
    return queue_add_job(queue, &(struct queue_job_params){.id = 1, .frames = &range, .priority = 50});
}

static void retry(struct queue_job *job, int64_t index, bool is_forced)
{
    struct frame_set indices;

    frame_set_init(&indices, job->states.frame_count);
    frame_set_add(&indices, index);
    assert_int_equal(queue_retry(job, &indices, 0, indices.limit, is_forced), 1);
    frame_set_finish(&indices);
}

// One letter for each frame of a load, the last one of a frame.
struct letters {
    char text[32];
};

static bool on_letter(void *user, const struct store_frame *frame, struct error *error)
{
    struct letters *letters = user;

    assert_true(frame->job == 1 && frame->index < (int32_t)sizeof letters->text - 1);
    letters->text[frame->index] = "qrsfcd"[frame->state];
    return true;
}

static bool on_any_job(void *user, const struct store_job *job, struct error *error)
{
    return true;
}

static struct letters load_letters(struct store *store)
{
    struct letters letters = {"----------"};
    struct error error = {0};

    if (!store_load(store, on_any_job, on_letter, &letters, &error)) fail_msg("%s", error.message);
    return letters;
}

static void marks_say_what_a_retry_leaves(void **state)
{
    struct store *store = open_store(*state);
    struct queue *queue = queue_create(3);
    struct queue_job *job = add_job(queue, "0-9");

    commit_one(store, job_op(1));
    queue_cancel(queue, job);
    retry(job, 7, false);
    commit_one(store, store_marks_format_op(job));
    assert_string_equal(load_letters(store).text, "ccccccc-cc");
    retry(job, 2, true); // it is forced: queued, and said to be
    commit_one(store, store_marks_format_op(job));
    assert_string_equal(load_letters(store).text, "ccqcccc-cc");
    commit_one(store, frame_op(1, 2, FRAME_SUCCEEDED)); // a row counts more
    assert_string_equal(load_letters(store).text, "ccscccc-cc");
    queue_fail_job(queue, job);
    retry(job, 0, false);
    commit_one(store, store_marks_format_op(job));
    assert_string_equal(load_letters(store).text, "-csccccfcc");
    for (int64_t i = 0; i < 10; i++)
        queue_restore_frame(job, i, FRAME_SKIPPED, 0);
    commit_one(store, store_marks_format_op(job));
    assert_string_equal(load_letters(store).text, "--s-------");
    queue_destroy(queue);
    store_close(store);
}

static int64_t ask(const struct folder *folder, const char *sql)
{
    sqlite3 *db = NULL;
    sqlite3_stmt *row = NULL;
    char path[128];
    int64_t answer;

    snprintf(path, sizeof path, "%s/queue.db", folder->path);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &row, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(row), SQLITE_ROW);
    answer = sqlite3_column_int64(row, 0);
    sqlite3_finalize(row);
    sqlite3_close(db);
    return answer;
}

static int64_t log_size(const struct folder *folder)
{
    struct stat status;
    char path[128];

    snprintf(path, sizeof path, "%s/queue.db-wal", folder->path);
    assert_int_equal(stat(path, &status), 0);
    return status.st_size;
}

static void only_what_changes_is_written(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct queue *queue = queue_create(3);
    struct queue_job *job = add_job(queue, "0-999999");
    int64_t before;

    commit_one(store, job_op(1));
    queue_cancel(queue, job);
    retry(job, 7, false);
    commit_one(store, store_marks_format_op(job));
    assert_in_range(ask(folder, "SELECT count(*) FROM mark"), 10, 1000);
    before = log_size(folder);
    retry(job, 500000, false);
    commit_one(store, store_marks_format_op(job));
    assert_in_range(log_size(folder) - before, 1, 64 * 1024); // all marks have a quarter of a million bytes
    assert_int_equal(ask(folder, "SELECT count(*) FROM mark WHERE sum IS NULL"), 0);
    commit_one(store, (struct store_op){.kind = STORE_DELETE_JOB, .job = {.id = 1}});
    assert_int_equal(ask(folder, "SELECT count(*) FROM mark"), 0);
    queue_destroy(queue);
    store_close(store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(marks_say_what_a_retry_leaves, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(only_what_changes_is_written, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
