// SIGKILL at every step of a commit, a backup, a repair and a restore.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_backup.h"
#include "daemon/store/store_counts.h"
#include "daemon/store/store_sql.h"
#include "daemon/store/store_sum.h"
#include "tests/daemon/store/store_fixture.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdint.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>

enum { JOB_COUNT = 3, STEP_LIMIT = 1000 };

// The process dies before its step of this number: a call that changes a file or a folder. 0: it lives.
static int fatal_step;

static void step(void)
{
    if (fatal_step > 0 && --fatal_step == 0) kill(getpid(), SIGKILL);
}

ssize_t pwrite64(int fd, const void *bytes, size_t size_bytes, off64_t offset);
ssize_t pwrite64(int fd, const void *bytes, size_t size_bytes, off64_t offset)
{
    step();
    return syscall(SYS_pwrite64, fd, bytes, size_bytes, offset);
}

ssize_t pwrite(int fd, const void *bytes, size_t size_bytes, off_t offset)
{
    return pwrite64(fd, bytes, size_bytes, offset);
}

// What a killed process wrote is there without a sync.
int fdatasync(int fd)
{
    (void)fd;
    step();
    return 0;
}

int fsync(int fd)
{
    (void)fd;
    step();
    return 0;
}

int unlink(const char *path)
{
    step();
    return (int)syscall(SYS_unlink, path);
}

int rename(const char *from, const char *to)
{
    step();
    return (int)syscall(SYS_rename, from, to);
}

int ftruncate64(int fd, off64_t size_bytes);
int ftruncate64(int fd, off64_t size_bytes)
{
    step();
    return (int)syscall(SYS_ftruncate, fd, size_bytes);
}

// The store has one job more than the copy and the backup, and the backup is what the row of its first job is mended
// from.
static void make_stage(const struct folder *folder)
{
    char *backup = xasprintf("%s/" STORE_BACKUP_NAME, folder->path), *copy = xasprintf("%s/copy.db", folder->root);
    struct store *store = open_store(folder);
    struct error error = {0};

    for (int64_t id = 1; id <= JOB_COUNT; id++)
        commit_one(store, job_op(id));
    if (!store_backup_save(folder->path, copy, &error) || !store_backup_save(folder->path, backup, &error))
        fail_msg("%s", error.message);
    commit_one(store, job_op(JOB_COUNT + 1));
    store_close(store);
    free(backup);
    free(copy);
}

static void clear(const char *path)
{
    DIR *entries = opendir(path);
    struct dirent *entry;

    while (entries && (entry = readdir(entries)))
        if (entry->d_name[0] != '.') unlinkat(dirfd(entries), entry->d_name, 0);
    if (entries) closedir(entries);
}

// Runs the act in a child that dies before step `number`. False when the child has come to the end of the act.
static bool dies_in(void (*act)(const struct folder *folder), const struct folder *folder, int number)
{
    pid_t child = fork();
    int status;

    if (child == 0) {
        fatal_step = number;
        act(folder);
        _exit(0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    if (WIFSIGNALED(status)) assert_int_equal(WTERMSIG(status), SIGKILL);
    assert_true(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
    return WIFSIGNALED(status);
}

// Kills the act at each of its steps, and looks at what is left each time.
static void kill_each_step(const struct folder *folder, void (*act)(const struct folder *folder),
                           void (*check)(const struct folder *folder))
{
    bool dies = true;
    int number = 0;

    while (dies) {
        clear(folder->path);
        make_stage(folder);
        dies = dies_in(act, folder, ++number);
        check(folder);
        assert_true(number < STEP_LIMIT);
    }
    assert_true(number > 5);
}

static int64_t read_integer(const struct folder *folder, const char *name, const char *sql)
{
    char *path = xasprintf("%s/%s", folder->path, name);
    struct error error = {0};
    sqlite3 *db = NULL;
    int64_t integer;

    assert_int_equal(sqlite3_open_v2(path, &db, SQLITE_OPEN_READWRITE, NULL), SQLITE_OK);
    if (!store_sql_read_integer(db, sql, &integer, &error)) fail_msg("%s: %s", name, error.message);
    sqlite3_close(db);
    free(path);
    return integer;
}

// Opens the store, which must be whole, and returns the count of its jobs.
static int check_store(const struct folder *folder)
{
    struct store_counts counts;
    struct store *store;
    struct loaded loaded;

    assert_true(store_counts_read(folder->path, &counts));
    assert_true(counts.last_job_id >= JOB_COUNT + 1);
    store = open_store(folder);
    loaded = load(store);
    assert_false(loaded.job.is_damaged || loaded.job.is_document_damaged);
    assert_string_equal(loaded.text, "{\"frames\": \"1-3\"} ash ada /films -");
    assert_true(store_next_job_id(store) > counts.last_job_id);
    assert_true(store_epoch(store) > counts.epoch);
    store_close(store);
    return loaded.jobs;
}

static void add_job(const struct folder *folder)
{
    struct store *store = store_open(folder->path, NULL, NULL);

    commit_one(store, job_op(JOB_COUNT + 2));
}

static void check_added(const struct folder *folder)
{
    struct store_counts counts;

    assert_true(store_counts_read(folder->path, &counts));
    assert_true(counts.last_job_id >= read_integer(folder, "queue.db", "SELECT max(id) FROM job"));
    assert_true(check_store(folder) >= JOB_COUNT + 1);
    // The row of the daemon was whole at each moment: to mend it lets epochs jump.
    assert_true(read_integer(folder, "queue.db", "SELECT epoch FROM daemon") < 1000);
}

static void a_killed_commit_has_counted_its_ids(void **state)
{
    kill_each_step(*state, add_job, check_added);
}

static void back_up(const struct folder *folder)
{
    char *path = xasprintf("%s/" STORE_BACKUP_NAME, folder->path);

    if (!store_backup_save(folder->path, path, NULL)) _exit(1);
    free(path);
}

static void check_backup(const struct folder *folder)
{
    int64_t jobs = read_integer(folder, STORE_BACKUP_NAME, "SELECT count(*) FROM job JOIN document ON job = id");
    char *part = xasprintf("%s/" STORE_BACKUP_NAME ".part", folder->path);

    assert_true(jobs == JOB_COUNT || jobs == JOB_COUNT + 1);
    assert_int_equal(check_store(folder), JOB_COUNT + 1);
    back_up(folder);
    assert_int_equal(read_integer(folder, STORE_BACKUP_NAME, "SELECT count(*) FROM job"), JOB_COUNT + 1);
    assert_int_not_equal(access(part, F_OK), 0);
    free(part);
}

static void a_killed_backup_leaves_the_older_one(void **state)
{
    kill_each_step(*state, back_up, check_backup);
}

static void damage_and_mend(const struct folder *folder)
{
    int step_number = fatal_step;
    sqlite3 *db = NULL;
    char *path = xasprintf("%s/queue.db", folder->path);

    fatal_step = 0;
    sqlite3_open(path, &db);
    sqlite3_exec(db, "UPDATE job SET name = 'another' WHERE id = 1; DELETE FROM document WHERE job = 2", NULL, NULL,
                 NULL);
    sqlite3_close(db);
    free(path);
    fatal_step = step_number;
    store_close(store_open(folder->path, NULL, NULL));
}

static void check_mended(const struct folder *folder)
{
    assert_int_equal(check_store(folder), JOB_COUNT + 1);
    assert_int_equal(read_integer(folder, "queue.db",
                                  "SELECT count(*) FROM job JOIN document ON job = id"
                                  " WHERE name = 'ash'"),
                     JOB_COUNT + 1);
}

static void a_killed_repair_is_done_by_the_next_start(void **state)
{
    kill_each_step(*state, damage_and_mend, check_mended);
}

static void restore(const struct folder *folder)
{
    char *copy = xasprintf("%s/copy.db", folder->root);
    bool has_counts = false;

    if (!store_backup_restore(folder->path, copy, &has_counts, NULL)) _exit(1);
    free(copy);
}

// The store is the old one or the new one, and what was put aside is whole.
static void check_restored(const struct folder *folder)
{
    int jobs = check_store(folder);

    assert_true(jobs == JOB_COUNT || jobs == JOB_COUNT + 1);
    if (jobs == JOB_COUNT)
        assert_int_equal(read_integer(folder, "queue.db.replaced", "SELECT count(*) FROM job"), JOB_COUNT + 1);
    restore(folder);
    assert_int_equal(check_store(folder), JOB_COUNT);
}

static void a_killed_restore_leaves_the_old_store_or_the_new(void **state)
{
    kill_each_step(*state, restore, check_restored);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_killed_commit_has_counted_its_ids, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_killed_backup_leaves_the_older_one, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_killed_repair_is_done_by_the_next_start, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_killed_restore_leaves_the_old_store_or_the_new, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
