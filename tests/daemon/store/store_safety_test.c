// The store when the disk, the file or the process fails, or a second daemon starts.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store.h"

#include "core/base/error.h"
#include "daemon/store/store_schema.h"
#include "tests/daemon/store/store_fixture.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

// When not 0, every write of SQLite fails with this errno, as on a full or broken disk.
static int write_errno;
// When set, a full disk on which only this reserve keeps room.
static const char *full_reserve;

ssize_t pwrite64(int fd, const void *bytes, size_t size_bytes, off64_t offset);
ssize_t pwrite64(int fd, const void *bytes, size_t size_bytes, off64_t offset)
{
    if (write_errno || (full_reserve && access(full_reserve, F_OK) == 0)) {
        errno = write_errno ? write_errno : ENOSPC;
        return -1;
    }
    return syscall(SYS_pwrite64, fd, bytes, size_bytes, offset);
}

int posix_fallocate(int fd, off_t offset, off_t size_bytes);
int posix_fallocate(int fd, off_t offset, off_t size_bytes)
{
    if (full_reserve) return ENOSPC;
    return ftruncate(fd, offset + size_bytes) == 0 ? 0 : errno;
}

static int sync_count;
static int sync_errno;

static int count_sync(long call, int fd)
{
    if (sync_errno) {
        errno = sync_errno;
        return -1;
    }
    sync_count++;
    return (int)syscall(call, fd);
}

int fdatasync(int fd)
{
    return count_sync(SYS_fdatasync, fd);
}

int fsync(int fd)
{
    return count_sync(SYS_fsync, fd);
}

static void commit_is_synced_before_it_is_acknowledged(void **state)
{
    struct store *store = open_store(*state);

    for (int64_t id = 1; id <= 5; id++) {
        sync_count = 0;
        commit_one(store, job_op(id));
        assert_true(sync_count >= 2); // of the id, and of the job
    }
    store_close(store);
}

static void failed_sync_fails_the_commit(void **state)
{
    struct store *store = open_store(*state);
    struct store_op op = frame_op(1, 0, FRAME_SUCCEEDED);
    struct error error = {0};

    commit_one(store, job_op(1));
    sync_errno = EIO;
    assert_false(store_commit(store, &op, 1, &error));
    sync_errno = 0;
    assert_string_equal(error.message, "store: cannot commit: Input/output error");
    assert_int_equal(load(store).frames, 0);
    assert_true(commit(store, &op, 1, &error));
    assert_int_equal(load(store).frames, 1);
    store_close(store);
}

static void failed_commit_leaves_nothing(void **state)
{
    struct store *store = open_store(*state);
    struct store_op ops[] = {job_op(1), frame_op(1, 0, FRAME_SUCCEEDED), job_op(1)};
    struct error error = {0};

    assert_false(commit(store, ops, 3, &error));
    assert_non_null(strstr(error.message, "store: cannot add a job: "));
    assert_int_equal(load(store).jobs, 0);
    assert_int_equal(load(store).frames, 0);
    assert_int_equal(store_next_job_id(store), 1);
    commit_one(store, job_op(1));
    assert_int_equal(load(store).jobs, 1);
    store_close(store);
}

static void full_disk_is_named_and_later_commits_work(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_op op = job_op(2);
    struct error error = {0};

    commit_one(store, job_op(1));
    write_errno = ENOSPC;
    assert_false(store_commit(store, &op, 1, &error));
    write_errno = 0;
    assert_string_equal(error.message, "store: cannot commit: disk full");
    assert_int_equal(load(store).jobs, 1);
    assert_true(commit(store, &op, 1, &error)); // the same op, with room on the disk
    store_close(store);

    store = open_store(folder);
    assert_int_equal(load(store).jobs, 2);
    store_close(store);
}

static void reserve_stores_what_a_full_disk_refuses(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct error error = {0};
    struct store_op op = job_op(1);
    char reserve[128], expected[256];

    snprintf(reserve, sizeof reserve, "%s/reserve", folder->path);
    snprintf(expected, sizeof expected, "store: the disk of %s is full", folder->path);
    assert_true(store_has_reserve(store));
    full_reserve = reserve;
    assert_true(commit(store, &op, 1, &error));
    assert_int_equal(load(store).jobs, 1);
    assert_false(store_has_reserve(store));
    assert_false(store_probe(store, &error));
    assert_string_equal(error.message, expected);
    full_reserve = NULL;
    assert_true(store_probe(store, &error));
    assert_true(store_has_reserve(store) && access(reserve, F_OK) == 0);
    store_close(store);
}

static void start_on_a_full_disk_uses_the_reserve_or_says_why(void **state)
{
    const struct folder *folder = *state;
    char reserve[128];
    struct error error = {0};
    struct store *store;
    bool is_full = false;

    snprintf(reserve, sizeof reserve, "%s/reserve", folder->path);
    store_close(open_store(folder));
    full_reserve = reserve;
    store = store_open(folder->path, &is_full, &error);
    assert_non_null(store);
    assert_false(store_has_reserve(store));
    store_close(store);
    full_reserve = NULL;
    write_errno = ENOSPC;
    assert_null(store_open(folder->path, &is_full, &error));
    write_errno = 0;
    assert_true(is_full);
    assert_string_equal(error.message, "store: cannot read: disk full");
    store_close(open_store(folder));
}

static void broken_disk_is_named(void **state)
{
    struct store *store = open_store(*state);
    struct store_op op = job_op(2);
    struct error error = {0};

    write_errno = EIO;
    assert_false(commit(store, &op, 1, &error));
    write_errno = 0;
    assert_string_equal(error.message, "store: cannot commit: Input/output error");
    store_close(store);
}

static void second_daemon_is_refused(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct error error = {0};
    char expected[256];

    snprintf(expected, sizeof expected, "another marchd (pid %ld) uses %s", (long)getpid(), folder->path);
    assert_null(store_open(folder->path, NULL, &error));
    assert_string_equal(error.message, expected);
    commit_one(store, job_op(1)); // the first daemon goes on
    store_close(store);
    store_close(open_store(folder));
}

static void write_bytes(const char *path, off_t offset, const void *bytes, size_t size_bytes)
{
    int fd = open(path, O_WRONLY | O_CREAT, 0600);

    assert_true(fd >= 0);
    assert_int_equal(pwrite(fd, bytes, size_bytes, offset), size_bytes);
    close(fd);
}

static uint64_t checksum(const char *path)
{
    FILE *file = fopen(path, "rb");
    uint64_t sum = 1469598103934665603u;
    int byte;

    assert_non_null(file);
    while ((byte = fgetc(file)) != EOF)
        sum = (sum ^ (uint64_t)byte) * 1099511628211u;
    fclose(file);
    return sum;
}

static void assert_refused(const struct folder *folder, const char *message)
{
    char path[128];
    struct error error = {0};
    uint64_t before;

    snprintf(path, sizeof path, "%s/queue.db", folder->path);
    before = checksum(path);
    assert_null(store_open(folder->path, NULL, &error));
    assert_string_equal(error.message, message);
    assert_true(checksum(path) == before);
}

static void newer_store_is_refused_and_unchanged(void **state)
{
    const struct folder *folder = *state;
    // The header's user_version, big-endian at byte 60.
    const unsigned char version[4] = {0, 0, 0, STORE_SCHEMA_VERSION + 1};
    char path[128], message[256];

    store_close(open_store(folder));
    snprintf(path, sizeof path, "%s/queue.db", folder->path);
    write_bytes(path, 60, version, sizeof version);
    snprintf(
        message, sizeof message,
        "store: written by a newer marchd (version %d, this one reads %d): install that one again, or restore a copy "
        "from before the upgrade (march restore FILE)",
        STORE_SCHEMA_VERSION + 1, STORE_SCHEMA_VERSION);
    assert_refused(folder, message);
}

static void database_of_another_program_is_refused(void **state)
{
    const struct folder *folder = *state;
    const unsigned char application[4] = {1, 2, 3, 4}; // application_id, at byte 68
    char path[128];

    store_close(open_store(folder));
    snprintf(path, sizeof path, "%s/queue.db", folder->path);
    write_bytes(path, 68, application, sizeof application);
    assert_refused(folder, "store: queue.db is a database of another program, expected marchd's");
}

static void file_that_is_no_database_is_refused(void **state)
{
    const struct folder *folder = *state;
    char path[128];
    char text[4096];

    memset(text, 'x', sizeof text);
    assert_int_equal(mkdir(folder->path, 0700), 0);
    snprintf(path, sizeof path, "%s/queue.db", folder->path);
    write_bytes(path, 0, text, sizeof text);
    assert_refused(folder, "store: cannot read: queue.db is no SQLite database, or its start is damaged");
}

static void damaged_page_without_a_backup_is_an_error(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct error error = {0};
    struct stat status;
    char path[128];
    char garbage[4096];

    commit_one(store, job_op(1));
    for (int32_t i = 0; i < 500; i++)
        commit_one(store, frame_op(1, i, FRAME_SUCCEEDED));
    store_close(store);
    snprintf(path, sizeof path, "%s/queue.db", folder->path);
    assert_int_equal(stat(path, &status), 0);
    memset(garbage, 0xee, sizeof garbage);
    write_bytes(path, status.st_size - (off_t)sizeof garbage, garbage, sizeof garbage);

    assert_null(store_open(folder->path, NULL, &error));
    assert_string_equal(error.message, "store: cannot read: queue.db is damaged: restore a backup (march restore)");
}

static void impossible_folder_is_named(void **state)
{
    const struct folder *folder = *state;
    struct error error = {0};
    char path[128];
    char expected[256];

    snprintf(path, sizeof path, "%s/deeper", folder->path);
    snprintf(expected, sizeof expected, "store: cannot make the folder %s: No such file or directory", path);
    assert_null(store_open(path, NULL, &error));
    assert_string_equal(error.message, expected);
}

// Commits frame after frame and writes each to the pipe when it is acknowledged.
static void commit_for_ever(const struct folder *folder, int pipe_fd)
{
    struct store *store = store_open(folder->path, NULL, NULL);

    if (!store) _exit(1);
    for (int32_t i = 0;; i++) {
        struct store_op ops[] = {frame_op(1, 2 * i, FRAME_SUCCEEDED), frame_op(1, 2 * i + 1, FRAME_SUCCEEDED)};

        if (!store_commit(store, ops, 2, NULL) || write(pipe_fd, &i, sizeof i) != sizeof i) _exit(1);
    }
}

static void acknowledged_commits_survive_sigkill(void **state)
{
    const struct folder *folder = *state;

    for (int round = 0; round < 5; round++) {
        int ends[2];
        int32_t acknowledged = -1, index;
        struct loaded loaded;
        struct store *store;
        pid_t child;

        assert_int_equal(pipe(ends), 0);
        child = fork();
        if (child == 0) commit_for_ever(folder, ends[1]);
        close(ends[1]);
        while (acknowledged < 20 + 13 * round && read(ends[0], &index, sizeof index) == sizeof index)
            acknowledged = index;
        kill(child, SIGKILL);
        while (read(ends[0], &index, sizeof index) == sizeof index)
            acknowledged = index;
        assert_int_equal(waitpid(child, NULL, 0), child);
        close(ends[0]);

        store = open_store(folder);
        loaded = load(store);
        assert_true(acknowledged >= 20 + 13 * round);
        assert_int_equal(loaded.frames % 2, 0); // commits of two frames are atomic
        assert_true(loaded.frames >= 2 * (acknowledged + 1));
        assert_int_equal(loaded.index_sum, (int64_t)loaded.frames * (loaded.frames - 1) / 2);
        store_close(store);
    }
}

// Grows the store until the limit of a file's size stops it; 0: as expected.
static int fill_up(const struct folder *folder)
{
    const struct rlimit limit = {.rlim_cur = 256 * 1024, .rlim_max = 256 * 1024};
    struct store *store = store_open(folder->path, NULL, NULL);
    struct error error = {0};
    int32_t committed = 0;

    signal(SIGXFSZ, SIG_IGN);
    if (!store || setrlimit(RLIMIT_FSIZE, &limit) != 0) return 1;
    for (;; committed++) {
        struct store_op op = frame_op(1, committed, FRAME_SUCCEEDED);

        if (!store_commit(store, &op, 1, &error)) break;
        if (committed > 100 * 1000) return 2;
    }
    if (!strstr(error.message, "File too large")) return 3;
    if (load(store).frames != committed) return 4;
    store_close(store);
    return 0;
}

static void size_limit_loses_nothing_committed(void **state)
{
    pid_t child = fork();
    struct store *store;
    int status;

    if (child == 0) _exit(fill_up(*state));
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    store = open_store(*state);
    assert_true(load(store).frames > 0);
    store_close(store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(commit_is_synced_before_it_is_acknowledged, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(failed_sync_fails_the_commit, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(failed_commit_leaves_nothing, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(full_disk_is_named_and_later_commits_work, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(reserve_stores_what_a_full_disk_refuses, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(start_on_a_full_disk_uses_the_reserve_or_says_why, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(broken_disk_is_named, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(second_daemon_is_refused, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(newer_store_is_refused_and_unchanged, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(database_of_another_program_is_refused, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(file_that_is_no_database_is_refused, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(damaged_page_without_a_backup_is_an_error, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(impossible_folder_is_named, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(acknowledged_commits_survive_sigkill, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(size_limit_loses_nothing_committed, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
