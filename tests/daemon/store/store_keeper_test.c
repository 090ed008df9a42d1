// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_keeper.h"

#include "tests/daemon/store/store_fixture.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <time.h>

static bool may_look = true;
static int repairs;

static bool may_run(void *user)
{
    (void)user;
    return may_look;
}

static void on_repair(void *user)
{
    (void)user;
    repairs++;
}

struct stage {
    uv_loop_t loop;
    struct store_keeper *keeper;
};

static void open_stage(struct stage *stage, const struct folder *folder)
{
    may_look = true;
    repairs = 0;
    uv_loop_init(&stage->loop);
    stage->keeper = store_keeper_open(
        &stage->loop,
        &(struct store_keeper_params){
            .folder = folder->path, .first_ms = 1, .interval_ms = 1, .may_run = may_run, .on_repair = on_repair});
}

static void close_stage(struct stage *stage)
{
    store_keeper_close(stage->keeper);
    uv_run(&stage->loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&stage->loop), 0);
}

static void look_again(struct stage *stage)
{
    int64_t looks = store_keeper_looks(stage->keeper);

    while (store_keeper_looks(stage->keeper) < looks + 2) // the first of them may have begun before
        uv_run(&stage->loop, UV_RUN_ONCE);
}

// Changes a row behind the store's back.
static void damage(const struct folder *folder, const char *file, const char *sql)
{
    char *path = xasprintf("%s/%s", folder->path, file);
    sqlite3 *db = NULL;

    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(db);
    free(path);
}

// Damages a row between two looks: one under way could copy what is damaged after it was looked at.
static void damage_and_look(struct stage *stage, const struct folder *folder, const char *sql)
{
    close_stage(stage);
    damage(folder, "queue.db", sql);
    open_stage(stage, folder);
    look_again(stage);
}

static void a_damaged_row_is_restored_from_the_backup_kept_before(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct stage stage;

    commit_one(store, job_op(1));
    open_stage(&stage, folder);
    look_again(&stage);
    assert_int_equal(repairs, 0);
    damage_and_look(&stage, folder, "UPDATE job SET name = 'another'");
    assert_int_equal(repairs, 1);
    assert_string_equal(load(store).text, "{\"frames\": \"1-3\"} ash ada /films -");
    close_stage(&stage);
    store_close(store);
}

// The backup has a time of ten years ahead.
static void set_clock_back(struct stage *stage, const struct folder *folder)
{
    char *path = xasprintf("%s/backup.db", folder->path);
    struct timespec times[2] = {{.tv_sec = time(NULL) + 315360000}, {.tv_sec = time(NULL) + 315360000}};

    close_stage(stage);
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
    open_stage(stage, folder);
    free(path);
}

static void the_backup_follows_the_store(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct stage stage;

    commit_one(store, job_op(1));
    open_stage(&stage, folder);
    look_again(&stage);
    set_clock_back(&stage, folder);
    commit_one(store, job_op(2));
    look_again(&stage);
    damage_and_look(&stage, folder, "UPDATE job SET name = 'another' WHERE id = 2");
    assert_int_equal(repairs, 1);
    assert_false(load(store).job.is_damaged);
    may_look = false;
    close_stage(&stage);
    store_close(store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_damaged_row_is_restored_from_the_backup_kept_before, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(the_backup_follows_the_store, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
