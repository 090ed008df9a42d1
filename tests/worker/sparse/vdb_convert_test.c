// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/vdb_convert.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/temp_folder.h"

#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { LONG_MS = 600 * 1000, SHORT_MS = 200 };

// Makes this script "nanovdb_convert" and "temporary" the folder of temporary files, both in the test's folder.
static void use_converter(void **state, const char *body)
{
    static char *search;
    const char *path = temp_folder_path(state, "nanovdb_convert"), *temporary = temp_folder_path(state, "temporary");
    struct error error = {{0}};
    char *here;

    if (!search) search = strdup(getenv("PATH"));
    assert_true(asprintf(&here, "%s:%s", (const char *)*state, search) > 0);
    setenv("PATH", here, 1);
    free(here);
    (void)mkdir(temporary, 0700);
    setenv("TMPDIR", temporary, 1);
    assert_true(file_write_atomic(path, body, strlen(body), &error));
    assert_int_equal(chmod(path, 0700), 0);
}

static void assert_nothing_left(void **state)
{
    assert_int_equal(rmdir(temp_folder_path(state, "temporary")), 0);
}

static void what_is_made_is_read_and_has_no_name(void **state)
{
    struct error error = {{0}};
    char text[16] = "";
    int fd;

    use_converter(state, "#!/bin/sh\n[ \"$1\" = -f ] && [ \"$2\" = /a.vdb ] && echo made >\"$3\"\n");
    fd = vdb_convert("/a.vdb", LONG_MS, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(read(fd, text, sizeof text - 1), 5);
    assert_string_equal(text, "made\n");
    close(fd);
    assert_nothing_left(state);
}

static void failures_leave_nothing(void **state)
{
    struct error error = {{0}};

    use_converter(state, "#!/bin/sh\necho half >\"$3\"; exit 3\n");
    assert_int_equal(vdb_convert("a.vdb", LONG_MS, &error), -1);
    assert_string_equal(error.message, "nanovdb_convert failed with exit status 3: is it an OpenVDB file?");
    use_converter(state, "#!/bin/sh\nkill -9 $$\n");
    assert_int_equal(vdb_convert("a.vdb", LONG_MS, &error), -1);
    assert_string_equal(error.message, "nanovdb_convert was ended by signal 9");
    use_converter(state, "#!/bin/sh\nrm \"$3\"\n");
    assert_int_equal(vdb_convert("a.vdb", LONG_MS, &error), -1);
    assert_non_null(strstr(error.message, "No such file"));
    assert_nothing_left(state);
}

static void one_that_hangs_is_ended(void **state)
{
    struct error error = {{0}};

    use_converter(state, "#!/bin/sh\nexec sleep 5000\n");
    assert_int_equal(vdb_convert("a.vdb", SHORT_MS, &error), -1);
    assert_string_equal(error.message, "nanovdb_convert had not ended after 0.2 s");
    assert_nothing_left(state);
}

static pid_t wait_for_pid(const char *path)
{
    for (int i = 0; i < 24000; ++i) {
        char *text = NULL;
        int pid = 0;

        if (file_read_text(path, 64, &text, NULL, NULL) && strchr(text, '\n')) pid = atoi(text);
        free(text);
        if (pid > 0) return pid;
        nanosleep(&(struct timespec){0, 25000000}, NULL);
    }
    fail_msg("the converter was not started");
    return -1;
}

// A zombie has ended too: it only waits for its new parent.
static bool is_gone(pid_t pid)
{
    char path[64], *text = NULL;
    bool is_zombie;

    snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
    if (!file_read_text(path, 4096, &text, NULL, NULL)) return true;
    is_zombie = strstr(text, ") Z") != NULL;
    free(text);
    return is_zombie;
}

static void a_killed_worker_takes_it_along_and_the_next_one_sweeps(void **state)
{
    struct error error = {{0}};
    pid_t worker, converter;
    bool gone = false;
    int fd;

    use_converter(state, "#!/bin/sh\necho $$ >\"${TMPDIR%/*}/pid\"; exec sleep 5000\n");
    worker = fork();
    if (worker == 0) _exit(vdb_convert("a.vdb", LONG_MS, NULL) >= 0);
    converter = wait_for_pid(temp_folder_path(state, "pid"));
    assert_int_equal(kill(worker, SIGKILL), 0);
    assert_int_equal(waitpid(worker, NULL, 0), worker);
    for (int i = 0; i < 24000 && !(gone = is_gone(converter)); ++i)
        nanosleep(&(struct timespec){0, 25000000}, NULL);
    assert_true(gone);
    assert_int_equal(rmdir(temp_folder_path(state, "temporary")), -1);

    use_converter(state, "#!/bin/sh\nexit 0\n");
    fd = vdb_convert("a.vdb", LONG_MS, &error);
    assert_true(fd >= 0);
    close(fd);
    assert_nothing_left(state);
}

static void what_others_convert_stays(void **state)
{
    int locked, fd;

    use_converter(state, "#!/bin/sh\nexit 0\n");
    locked = open(temp_folder_path(state, "temporary/marchd-vdb-abcdef.nvdb"), O_CREAT | O_RDWR, 0600);
    assert_int_equal(flock(locked, LOCK_EX), 0);
    assert_int_equal(close(open(temp_folder_path(state, "temporary/mine.nvdb"), O_CREAT | O_RDWR, 0600)), 0);
    fd = vdb_convert("a.vdb", LONG_MS, NULL);
    assert_true(fd >= 0);
    close(fd);
    close(locked);
    assert_int_equal(remove(temp_folder_path(state, "temporary/marchd-vdb-abcdef.nvdb")), 0);
    assert_int_equal(remove(temp_folder_path(state, "temporary/mine.nvdb")), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_is_made_is_read_and_has_no_name, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(failures_leave_nothing, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(one_that_hangs_is_ended, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_killed_worker_takes_it_along_and_the_next_one_sweeps, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(what_others_convert_stays, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
