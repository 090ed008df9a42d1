// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_lock.h"

#include "tests/daemon/store/store_fixture.h"

#include <signal.h>
#include <sys/wait.h>

// What a killed daemon leaves: its pid in the file, and a child that shares the lock until its program is executed. The
// child ends `for_ms` after the start. Returns its pid.
static pid_t leave_child(const struct folder *folder, int for_ms)
{
    int ready[2];
    pid_t daemon, child = 0;

    assert_int_equal(pipe(ready), 0);
    daemon = fork();
    if (daemon == 0) {
        int fd = store_lock_take(folder->path, 0, NULL);

        child = fd >= 0 ? fork() : -1;
        if (child == 0) {
            close(ready[0]);
            usleep((useconds_t)for_ms * 1000);
            _exit(0);
        }
        if (child < 0 || write(ready[1], &child, sizeof child) != sizeof child) _exit(1);
        _exit(0);
    }
    assert_int_equal(read(ready[0], &child, sizeof child), sizeof child);
    assert_int_equal(waitpid(daemon, NULL, 0), daemon);
    close(ready[0]);
    close(ready[1]);
    return child;
}

static void the_lock_of_a_killed_daemon_is_waited_for(void **state)
{
    int fd;

    leave_child(*state, 200);
    fd = store_lock_take(((struct folder *)*state)->path, STORE_LOCK_WAIT_MS, NULL);
    assert_true(fd >= 0);
    close(fd);
}

static void who_keeps_the_lock_is_named(void **state)
{
    const struct folder *folder = *state;
    pid_t child = leave_child(folder, 60 * 1000);
    struct error error = {0};
    char expected[64];

    assert_int_equal(store_lock_take(folder->path, 20, &error), -1);
    snprintf(expected, sizeof expected, "process %ld keeps ", (long)child);
    assert_memory_equal(error.message, expected, strlen(expected));
    assert_int_equal(kill(child, SIGKILL), 0);
}

static void a_daemon_that_runs_is_not_waited_for(void **state)
{
    const struct folder *folder = *state;
    int fd = store_lock_take(folder->path, 0, NULL), status;
    struct error error = {0};
    char expected[64];
    pid_t other;

    assert_true(fd >= 0);
    other = fork();
    if (other == 0) {
        bool ok;

        close(fd);
        ok = store_lock_take(folder->path, STORE_LOCK_WAIT_MS, &error) < 0;
        snprintf(expected, sizeof expected, "another marchd (pid %ld) uses ", (long)getppid());
        _exit(ok && strncmp(error.message, expected, strlen(expected)) == 0 ? 0 : 1);
    }
    assert_int_equal(waitpid(other, &status, 0), other);
    assert_int_equal(status, 0);
    close(fd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_lock_of_a_killed_daemon_is_waited_for, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(who_keeps_the_lock_is_named, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_daemon_that_runs_is_not_waited_for, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
