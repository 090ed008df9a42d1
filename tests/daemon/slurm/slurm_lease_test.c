// The counter of a lease: that it moves, where it may lie, and the script that ends without it.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/slurm/slurm_lease.h"

#include "core/base/alloc.h"
#include "daemon/settings/slurm_commands.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char scratch[] = "/tmp/slurm_lease_test.XXXXXX";
static char *folder; // owned; of the lease
static uv_loop_t loop;

static int set_up(void **state)
{
    strcpy(scratch + strlen(scratch) - 6, "XXXXXX");
    assert_non_null(mkdtemp(scratch));
    folder = xasprintf("%s/lease", scratch);
    return uv_loop_init(&loop);
}

static int tear_down(void **state)
{
    char *command = xasprintf("rm -rf %s", scratch);

    assert_int_equal(system(command), 0);
    free(command);
    free(folder);
    return uv_loop_close(&loop);
}

static void move(struct slurm_lease *lease)
{
    slurm_lease_move(lease);
    uv_run(&loop, UV_RUN_DEFAULT);
}

static long long read_count(const struct slurm_lease *lease)
{
    FILE *file = fopen(slurm_lease_path(lease), "r");
    long long count = 0;

    assert_non_null(file);
    assert_int_equal(fscanf(file, "%lld", &count), 1);
    fclose(file);
    return count;
}

// Another daemon goes on where one ended: the counter moves.
static void it_moves(void **state)
{
    struct slurm_lease *lease = slurm_lease_create(&loop, folder, "x");

    assert_false(slurm_lease_is_held(lease));
    move(lease);
    assert_true(slurm_lease_is_held(lease));
    assert_null(slurm_lease_trouble(lease));
    assert_int_equal(read_count(lease), 1);
    move(lease);
    slurm_lease_close(lease);
    lease = slurm_lease_create(&loop, folder, "x");
    move(lease);
    assert_int_equal(read_count(lease), 3);
    slurm_lease_close(lease);
}

static void assert_refused(const char *expected)
{
    struct slurm_lease *lease = slurm_lease_create(&loop, folder, "x");

    move(lease);
    assert_false(slurm_lease_is_held(lease));
    if (!strstr(slurm_lease_trouble(lease), expected)) fail_msg("%s", slurm_lease_trouble(lease));
    slurm_lease_close(lease);
}

static void it_is_the_daemons_own(void **state)
{
    char *path = xasprintf("%s/x", folder);

    assert_int_equal(mkdir(folder, 0700) + chmod(folder, 0770), 0);
    assert_refused("only the daemon's user may write");
    assert_int_equal(chmod(folder, 0700) + symlink("/dev/null", path), 0);
    assert_refused("Too many levels");
    assert_int_equal(unlink(path) + rmdir(folder) + symlink("/tmp", folder), 0);
    assert_refused("Not a directory");
    assert_int_equal(unlink(folder), 0);
    free(path);
}

// By a shell, with a stillness of one second.
static void the_script_ends_without_it(void **state)
{
    char *path = xasprintf("%s/it's", scratch), *script = slurm_commands_format_script(path, 1000);
    int status;
    pid_t pid = fork();

    if (pid == 0) {
        execl("/bin/sh", "sh", "-c", script, (char *)NULL);
        _exit(127);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    free(path);
    free(script);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(it_moves, set_up, tear_down),
                                       cmocka_unit_test_setup_teardown(it_is_the_daemons_own, set_up, tear_down),
                                       cmocka_unit_test_setup_teardown(the_script_ends_without_it, set_up, tear_down)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
