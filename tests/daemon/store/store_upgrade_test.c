// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store.h"

#include "daemon/store/store_reader.h"
#include "daemon/store/store_sum.h"
#include "tests/daemon/store/store_fixture.h"

#include <sqlite3.h>
#include <sys/stat.h>

// A store of the first version: a job with one frame in each state.
static const char first_version[] =
    "PRAGMA journal_mode = WAL; PRAGMA application_id = 1299342184; PRAGMA user_version = 1;"
    "CREATE TABLE daemon (epoch INTEGER NOT NULL);"
    "INSERT INTO daemon VALUES (5);"
    "CREATE TABLE job (id INTEGER PRIMARY KEY, name TEXT, owner TEXT, owner_uid INTEGER NOT NULL,"
    " priority INTEGER NOT NULL, is_paused INTEGER NOT NULL, is_canceled INTEGER NOT NULL, is_failed INTEGER NOT NULL,"
    " submitted_ms INTEGER NOT NULL, started_ms INTEGER NOT NULL, finished_ms INTEGER NOT NULL, reason TEXT, root "
    "TEXT);"
    "CREATE TABLE document (job INTEGER PRIMARY KEY, text TEXT NOT NULL);"
    "CREATE TABLE frame (job INTEGER NOT NULL, frame_index INTEGER NOT NULL, state INTEGER NOT NULL,"
    " attempts INTEGER NOT NULL DEFAULT 0, epoch INTEGER NOT NULL DEFAULT 0, inode INTEGER NOT NULL DEFAULT 0,"
    " size_bytes INTEGER NOT NULL DEFAULT 0, hash TEXT, render_s REAL NOT NULL DEFAULT 0,"
    " encode_s REAL NOT NULL DEFAULT 0, error TEXT, PRIMARY KEY (job, frame_index)) WITHOUT ROWID;"
    "CREATE TABLE attempt (job INTEGER NOT NULL, number INTEGER NOT NULL, frame INTEGER NOT NULL,"
    " attempt INTEGER NOT NULL, worker INTEGER NOT NULL, ended_ms INTEGER NOT NULL, outcome TEXT NOT NULL, log TEXT,"
    " PRIMARY KEY (job, number)) WITHOUT ROWID;"
    "INSERT INTO job VALUES (3, 'ash', 'ada', 1000, 70, 0, 0, 0, 10, 20, 0, NULL, '/films');"
    "INSERT INTO document VALUES (3, '{\"frames\": \"1-3\"}');"
    "INSERT INTO frame VALUES (3, 0, 2, 1, 5, 77, 123, 'aa', 1.5, 0.25, NULL);"
    "INSERT INTO frame VALUES (3, 1, 3, 3, 5, 0, 0, NULL, 0, 0, 'no light');"
    "INSERT INTO frame VALUES (3, 2, 1, 2, 5, 78, 124, 'bb', 2.5, 0.5, NULL);"
    "INSERT INTO attempt VALUES (3, 1, 2, 1, 4, 99, 'failed', 'why');";

static void make_first_version(const struct folder *folder)
{
    sqlite3 *db = NULL;
    char path[128];

    snprintf(path, sizeof path, "%s/queue.db", folder->path);
    assert_int_equal(mkdir(folder->path, 0700), 0);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, first_version, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

struct rows {
    int count;
    struct store_frame frames[3];
    char error[32];
};

static bool on_row(void *user, const struct store_frame *frame, struct error *error)
{
    struct rows *rows = user;

    assert_true(rows->count < 3);
    if (frame->error) snprintf(rows->error, sizeof rows->error, "%s", frame->error);
    rows->frames[rows->count++] = *frame;
    return true;
}

static struct rows read_rows(const struct folder *folder)
{
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    struct error error = {0};
    struct rows rows = {0};

    assert_non_null(reader);
    if (!store_read_frames(reader, 3, 0, 2, on_row, &rows, &error)) fail_msg("%s", error.message);
    store_reader_close(reader);
    assert_int_equal(rows.count, 3);
    return rows;
}

static void store_of_the_first_version_is_kept_whole(void **state)
{
    const struct folder *folder = *state;
    struct loaded loaded;
    struct store *store;
    struct rows rows;

    make_first_version(folder);
    store = open_store(folder);
    assert_int_equal(store_epoch(store), 6);
    assert_int_equal(store_next_job_id(store), 4);
    loaded = load(store);
    assert_string_equal(loaded.text, "{\"frames\": \"1-3\"} ash ada /films -");
    assert_int_equal(loaded.frames, 3);
    assert_int_equal(loaded.frame.state, FRAME_RUNNING); // a publish intent, with its whole row
    assert_true(loaded.frame.inode == 78 && loaded.frame.size_bytes == 124);
    rows = read_rows(folder);
    assert_int_equal(rows.frames[0].state, FRAME_SUCCEEDED);
    assert_true(rows.frames[0].render_s == 1.5 && rows.frames[0].encode_s == 0.25);
    assert_string_equal(rows.frames[0].hash, "aa");
    assert_string_equal(rows.error, "no light");
    for (int i = 0; i < 3; i++) {
        assert_string_equal(rows.frames[i].accuracy.audit, "");
        assert_false(rows.frames[i].accuracy.has_cut_share);
        assert_true(rows.frames[i].accuracy.traced == 0.0);
    }
    store_close(store);
}

static void upgraded_store_is_a_farm_with_an_id(void **state)
{
    const struct folder *folder = *state;
    struct store_reader *reader;
    struct store *store;
    char farm[ROOT_MARKER_ID_SIZE];
    struct error error = {0};

    make_first_version(folder);
    store = open_store(folder);
    reader = store_reader_open(folder->path, NULL);
    assert_non_null(reader);
    if (!store_read_farm(reader, farm, &error)) fail_msg("%s", error.message);
    store_reader_close(reader);
    store_close(store);
}

static void change_rows(const struct folder *folder, const char *sql)
{
    sqlite3 *db = NULL;
    char path[128];

    snprintf(path, sizeof path, "%s/queue.db", folder->path);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(store_sum_register(db, NULL), true);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

// In version 9 a frame that a retry left canceled had a row.
static void marks_of_version_9_are_kept(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct loaded loaded;

    commit_one(store, job_op(1));
    store_close(store);
    change_rows(folder, "DROP TABLE mark; DROP TABLE token; DROP TABLE notice; DROP TABLE told; ALTER TABLE job DROP "
                        "COLUMN waits; PRAGMA user_version = 9; INSERT INTO "
                        "frame (job, frame_index, state, sum)"
                        " VALUES (1, 2, 4, row_sum(1, 2, 4, 0, 0, 0, 0, NULL, 0.0, 0.0))");
    store = open_store(folder);
    loaded = load(store);
    assert_int_equal(loaded.jobs, 1);
    assert_int_equal(loaded.frames, 1);
    assert_true(loaded.frame.index == 2 && loaded.frame.state == FRAME_CANCELED);
    commit_one(store, (struct store_op){.kind = STORE_SET_MARKS,
                                        .marks = {.job = 1, .bytes = xcalloc(1, 1), .size_bytes = 1}});
    store_close(store);
}

static void upgraded_store_takes_new_columns(void **state)
{
    const struct folder *folder = *state;
    struct store *store;
    struct store_op op;
    struct rows rows;

    make_first_version(folder);
    store_close(open_store(folder));
    store = open_store(folder);
    assert_int_equal(store_epoch(store), 7);
    op = frame_op(3, 2, FRAME_SUCCEEDED);
    op.frame.audit_s = 0.75;
    commit_one(store, op);
    commit_one(store, (struct store_op){.kind = STORE_SET_USAGE, .usage = {1000, 1.5, 7}});
    rows = read_rows(folder);
    assert_accuracy(&rows.frames[2].accuracy);
    assert_true(rows.frames[2].audit_s == 0.75 && rows.frames[0].audit_s == 0);
    assert_string_equal(rows.frames[0].accuracy.method, "");
    store_close(store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(store_of_the_first_version_is_kept_whole, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(upgraded_store_is_a_farm_with_an_id, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(marks_of_version_9_are_kept, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(upgraded_store_takes_new_columns, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
