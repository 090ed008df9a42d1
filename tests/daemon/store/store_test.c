// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/store/store_counts.h"
#include "daemon/store/store_reader.h"
#include "tests/daemon/store/store_fixture.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

static void new_folder_is_private(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct stat status;

    assert_int_equal(stat(folder->path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0700);
    assert_int_equal(store_next_job_id(store), 1);
    store_close(store);
}

static void each_start_has_its_epoch(void **state)
{
    const struct folder *folder = *state;

    for (int64_t epoch = 1; epoch <= 3; epoch++) {
        struct store *store = open_store(folder);

        assert_int_equal(store_epoch(store), epoch);
        store_close(store);
    }
}

static void job_is_loaded_as_it_was_stored(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_op change = {.kind = STORE_SET_JOB, .job = {.id = 4}};
    struct loaded loaded;

    commit_one(store, job_op(4));
    assert_int_equal(store_next_job_id(store), 5);
    change.job.priority = 90;
    change.job.is_paused = true;
    change.job.submitted_ms = 1;
    change.job.started_ms = 2;
    change.job.finished_ms = 3;
    change.job.reason = xstrdup("disk full");
    commit_one(store, change);
    store_close(store);

    store = open_store(folder);
    loaded = load(store);
    assert_int_equal(loaded.jobs, 1);
    assert_string_equal(loaded.text, "{\"frames\": \"1-3\"} ash ada /films disk full");
    assert_int_equal(loaded.job.owner_uid, 1000);
    assert_int_equal(loaded.job.priority, 90);
    assert_true(loaded.job.is_paused);
    assert_false(loaded.job.is_canceled);
    assert_int_equal(loaded.job.started_ms, 2);
    assert_int_equal(loaded.job.finished_ms, 3);
    assert_int_equal(store_next_job_id(store), 5);
    store_close(store);
}

static void a_store_that_lost_its_name_takes_nothing(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    char *path = xasprintf("%s/queue.db", folder->path), *aside = xasprintf("%s/aside.db", folder->path);
    struct store_op op = job_op(2);
    struct error error = {0};
    struct loaded loaded;
    FILE *other;

    commit_one(store, job_op(1));
    assert_int_equal(rename(path, aside), 0);
    assert_false(store_commit(store, &op, 1, &error));
    assert_non_null(strstr(error.message, "/queue.db was removed or replaced"));
    assert_false(store_is_full(store));
    assert_false(store_probe(store, NULL));
    // Another file of its name is another store.
    other = fopen(path, "w");
    assert_non_null(other);
    fclose(other);
    assert_false(store_commit(store, &op, 1, NULL));
    assert_int_equal(rename(aside, path), 0);
    assert_true(store_probe(store, NULL));
    assert_true(store_commit(store, &op, 1, NULL));
    store_close(store);

    store = open_store(folder);
    loaded = load(store);
    assert_int_equal(loaded.jobs, 2);
    store_close(store);
    store_op_finish(&op);
    free(path);
    free(aside);
}

static void a_store_that_lost_its_log_takes_nothing(void **state)
{
    const struct folder *folder = *state;
    char *path = xasprintf("%s/queue.db-wal", folder->path), *aside = xasprintf("%s/aside.db", folder->path);
    struct store *store = open_store(folder);
    struct store_op op = job_op(1);
    struct error error = {0};

    assert_int_equal(rename(path, aside), 0);
    assert_false(store_commit(store, &op, 1, &error));
    assert_non_null(strstr(error.message, "/queue.db-wal was removed or replaced"));
    // Another file of its name is another log.
    close(open(path, O_WRONLY | O_CREAT, 0600));
    assert_false(store_probe(store, NULL));
    assert_int_equal(rename(aside, path), 0);
    assert_true(store_probe(store, NULL));
    assert_true(store_commit(store, &op, 1, NULL));
    store_close(store);
    store_op_finish(&op);
    free(path);
    free(aside);
}

static void what_a_lost_log_held_is_in_the_store(void **state)
{
    const struct folder *folder = *state;
    char *path = xasprintf("%s/queue.db-wal", folder->path);
    pid_t child = fork();
    struct store *store;
    int status;

    if (child == 0) {
        struct store_op op = job_op(2);

        store = store_open(folder->path, NULL, NULL);
        commit_one(store, job_op(1));
        unlink(path);
        _exit(store_commit(store, &op, 1, NULL) ? 1 : 0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    store = open_store(folder);
    assert_int_equal(load(store).jobs, 1);
    store_close(store);
    free(path);
}

static void a_job_whose_id_cannot_be_counted_is_refused(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    char *path = xasprintf("%s/counts", folder->path);
    struct store_op op = job_op(1);
    struct store_counts counts;
    struct error error = {0};

    assert_int_equal(unlink(path), 0);
    assert_int_equal(mkdir(path, 0700), 0);
    assert_false(store_commit(store, &op, 1, &error));
    assert_non_null(strstr(error.message, "cannot count ids in"));
    assert_false(store_probe(store, NULL));
    assert_int_equal(rmdir(path), 0);
    assert_true(store_probe(store, NULL));
    assert_true(store_commit(store, &op, 1, NULL));
    assert_true(store_counts_read(folder->path, &counts));
    assert_int_equal(counts.last_job_id, 1);
    store_close(store);
    store_op_finish(&op);
    free(path);
}

static void change_of_an_unknown_job_is_an_error(void **state)
{
    struct store *store = open_store(*state);
    struct store_op op = {.kind = STORE_SET_JOB, .job = {.id = 4}};
    struct error error = {0};

    assert_false(commit(store, &op, 1, &error));
    assert_string_equal(error.message, "store: cannot change job 4: the store has no such job");
    store_close(store);
}

static void intent_is_loaded_whole(void **state)
{
    struct store *store = open_store(*state);
    struct loaded loaded;

    commit_one(store, job_op(1));
    commit_one(store, frame_op(1, 3, FRAME_RUNNING));
    loaded = load(store);
    assert_int_equal(loaded.frame.state, FRAME_RUNNING);
    assert_int_equal(loaded.frame.index, 3);
    assert_int_equal(loaded.frame.attempts, 2);
    assert_int_equal(loaded.frame.epoch, 7);
    assert_true(loaded.frame.inode == UINT64_MAX - 5);
    assert_true(loaded.frame.size_bytes == 123456789012);
    assert_string_equal(loaded.frame.hash, "00112233445566778899aabbccddeeff");
    assert_accuracy(&loaded.frame.accuracy);
    store_close(store);
}

static void result_takes_the_place_of_the_intent(void **state)
{
    struct store *store = open_store(*state);
    struct loaded loaded;

    commit_one(store, job_op(1));
    commit_one(store, frame_op(1, 3, FRAME_RUNNING));
    commit_one(store, frame_op(1, 3, FRAME_SUCCEEDED));
    loaded = load(store);
    assert_int_equal(loaded.frames, 1);
    assert_int_equal(loaded.frame.state, FRAME_SUCCEEDED);
    assert_int_equal(loaded.frame.attempts, 2);
    store_close(store);
}

static void reset_frames_have_no_row(void **state)
{
    struct store *store = open_store(*state);
    struct store_op op = {.kind = STORE_RESET_FRAMES, .reset = {.job = 1, .count = 4}};
    const int32_t indices[] = {2, 3, 4, 8};
    struct loaded loaded;

    for (int32_t i = 0; i < 10; i++) {
        commit_one(store, frame_op(1, i, FRAME_FAILED));
        commit_one(store, frame_op(2, i, FRAME_FAILED));
    }
    op.reset.indices = xmalloc(sizeof indices);
    memcpy(op.reset.indices, indices, sizeof indices);
    commit_one(store, op);
    loaded = load(store);
    assert_int_equal(loaded.frames, 16);
    assert_int_equal(loaded.index_sum, 45 - 17 + 45);
    store_close(store);
}

static void reader_sees_what_is_committed(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    struct loaded rows = {0};
    struct error error = {0};
    char *document;

    assert_non_null(reader);
    commit_one(store, job_op(1));
    for (int32_t i = 0; i < 10; i++)
        commit_one(store, frame_op(1, i, FRAME_SUCCEEDED));
    assert_true(store_read_frames(reader, 1, 3, 5, on_frame, &rows, &error));
    assert_int_equal(rows.frames, 3);
    assert_int_equal(rows.frame.index, 5);
    assert_true(rows.frame.render_s == 1.5 && rows.frame.encode_s == 0.25);
    assert_accuracy(&rows.frame.accuracy);
    assert_true(store_read_document(reader, 1, &document, &error));
    assert_string_equal(document, "{\"frames\": \"1-3\"}");
    free(document);
    assert_false(store_read_document(reader, 9, &document, &error));
    assert_string_equal(error.message, "store: no job 9");
    store_reader_close(reader);
    store_close(store);
}

struct seen_attempts {
    int count, first, last;
    char text[64];
};

static bool on_attempt(void *user, const struct store_attempt *attempt, struct error *error)
{
    struct seen_attempts *seen = user;

    if (seen->count++ == 0) seen->first = attempt->attempt;
    seen->last = attempt->attempt;
    snprintf(seen->text, sizeof seen->text, "%d %s %s %" PRId64, attempt->worker, attempt->outcome, attempt->log,
             attempt->ended_ms);
    return true;
}

static struct store_op attempt_op(int64_t job, int32_t frame, int attempt)
{
    return (struct store_op){.kind = STORE_ADD_ATTEMPT,
                             .attempt = {.job = job,
                                         .frame = frame,
                                         .attempt = attempt,
                                         .worker = 3,
                                         .ended_ms = 77,
                                         .outcome = "lost",
                                         .log = xstrdup("killed")}};
}

static void attempts_are_read_newest_first(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    struct seen_attempts all = {0}, of_frame = {0}, limited = {0};

    for (int attempt = 1; attempt <= 6; attempt++)
        commit_one(store, attempt_op(1, attempt % 2, attempt));
    commit_one(store, attempt_op(2, 0, 1));
    assert_true(store_read_attempts(reader, 1, -1, 100, on_attempt, &all, NULL));
    assert_int_equal(all.count, 6);
    assert_int_equal(all.first, 6);
    assert_int_equal(all.last, 1);
    assert_string_equal(all.text, "3 lost killed 77");
    assert_true(store_read_attempts(reader, 1, 1, 100, on_attempt, &of_frame, NULL));
    assert_int_equal(of_frame.count, 3);
    assert_int_equal(of_frame.first, 5);
    assert_true(store_read_attempts(reader, 1, -1, 2, on_attempt, &limited, NULL));
    assert_int_equal(limited.count, 2);
    store_reader_close(reader);
    store_close(store);
}

static void only_the_newest_attempts_of_a_job_are_kept(void **state)
{
    enum { COUNT = STORE_ATTEMPT_LIMIT + 50 };
    static struct store_op ops[COUNT + 1];
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    struct seen_attempts seen = {0}, other = {0};

    for (int i = 0; i < COUNT; i++)
        ops[i] = attempt_op(1, 0, i + 1);
    ops[COUNT] = attempt_op(2, 0, 1);
    assert_true(commit(store, ops, COUNT + 1, NULL));
    assert_true(store_read_attempts(reader, 1, -1, 2 * COUNT, on_attempt, &seen, NULL));
    assert_int_equal(seen.count, STORE_ATTEMPT_LIMIT);
    assert_int_equal(seen.first, COUNT);
    assert_true(store_read_attempts(reader, 2, -1, 2 * COUNT, on_attempt, &other, NULL));
    assert_int_equal(other.count, 1);
    store_reader_close(reader);
    store_close(store);
}

static bool on_any_attempt(void *user, const struct store_attempt *attempt, struct error *error)
{
    ++*(int *)user;
    return true;
}

static void a_deleted_job_leaves_no_row_and_its_id_is_not_used_again(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    struct loaded loaded;
    char *document = NULL;
    int attempts = 0;

    commit_one(store, job_op(6));
    commit_one(store, job_op(7));
    commit_one(store, frame_op(6, 0, FRAME_SUCCEEDED));
    commit_one(store, frame_op(7, 0, FRAME_SUCCEEDED));
    commit_one(store, frame_op(7, 1, FRAME_FAILED));
    commit_one(store, attempt_op(7, 1, 1));
    commit_one(store, (struct store_op){.kind = STORE_DELETE_JOB, .job = {.id = 7}});
    assert_false(store_read_document(reader, 7, &document, NULL));
    assert_true(store_read_attempts(reader, 7, -1, 10, on_any_attempt, &attempts, NULL));
    assert_int_equal(attempts, 0);
    store_reader_close(reader);
    store_close(store);

    store = open_store(folder);
    loaded = load(store);
    assert_int_equal(loaded.jobs, 1);
    assert_int_equal(loaded.job.id, 6);
    assert_int_equal(loaded.frames, 1);
    assert_int_equal(loaded.frame.job, 6);
    assert_true(loaded.frame.size_bytes == 123456789012);
    assert_int_equal(store_next_job_id(store), 8);
    store_close(store);
}

static bool on_usage(void *user, const struct store_usage *usage, struct error *error)
{
    char *text = user;

    sprintf(text + strlen(text), "%" PRId64 " %g %" PRId64 ";", usage->owner_uid, usage->used_s, usage->at_ms);
    return true;
}

static void use_of_the_farm_is_remembered(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_reader *reader;
    char text[64] = "";

    commit_one(store, (struct store_op){.kind = STORE_SET_USAGE, .usage = {1000, 1.5, 7}});
    commit_one(store, (struct store_op){.kind = STORE_SET_USAGE, .usage = {3, 2, 8}});
    commit_one(store, (struct store_op){.kind = STORE_SET_USAGE, .usage = {1000, 0.25, 9}});
    store_close(store);

    store = open_store(folder);
    reader = store_reader_open(folder->path, NULL);
    assert_true(store_read_usage(reader, on_usage, text, NULL));
    assert_string_equal(text, "3 2 8;1000 0.25 9;");
    store_reader_close(reader);
    store_close(store);
}

static bool on_root(void *user, const struct store_root *root, struct error *error)
{
    char *text = user;

    strcat(strcat(strcat(strcat(text, root->path), " "), root->id), ";");
    return true;
}

static void farm_and_roots_are_remembered(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    char farm[ROOT_MARKER_ID_SIZE], later[ROOT_MARKER_ID_SIZE], roots[64] = "";

    assert_true(store_read_farm(reader, farm, NULL));
    commit_one(store, (struct store_op){.kind = STORE_SET_ROOT, .root = {xstrdup("/films"), xstrdup("aa")}});
    commit_one(store, (struct store_op){.kind = STORE_SET_ROOT, .root = {xstrdup("/art"), xstrdup("bb")}});
    commit_one(store, (struct store_op){.kind = STORE_SET_ROOT, .root = {xstrdup("/films"), xstrdup("cc")}});
    store_reader_close(reader);
    store_close(store);

    store = open_store(folder);
    reader = store_reader_open(folder->path, NULL);
    assert_true(store_read_farm(reader, later, NULL));
    assert_string_equal(later, farm);
    assert_true(store_read_roots(reader, on_root, roots, NULL));
    assert_string_equal(roots, "/art bb;/films cc;");
    store_reader_close(reader);
    store_close(store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(new_folder_is_private, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(each_start_has_its_epoch, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(job_is_loaded_as_it_was_stored, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_store_that_lost_its_name_takes_nothing, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_store_that_lost_its_log_takes_nothing, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_a_lost_log_held_is_in_the_store, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_job_whose_id_cannot_be_counted_is_refused, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(change_of_an_unknown_job_is_an_error, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(intent_is_loaded_whole, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(result_takes_the_place_of_the_intent, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(reset_frames_have_no_row, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(reader_sees_what_is_committed, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(attempts_are_read_newest_first, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_deleted_job_leaves_no_row_and_its_id_is_not_used_again, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(use_of_the_farm_is_remembered, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(farm_and_roots_are_remembered, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(only_the_newest_attempts_of_a_job_are_kept, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
