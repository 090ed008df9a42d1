// SPDX-License-Identifier: Apache-2.0
#include "node/worker_environment.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static bool has(char *const environment[], const char *variable)
{
    size_t count = 0;

    for (size_t i = 0; environment[i]; i++)
        count += strncmp(environment[i], variable, strlen(variable)) == 0;
    assert_true(count <= 1);
    return count == 1;
}

static void variables_of_the_daemon_and_secrets_are_left_out(void **state)
{
    static const char *const dropped[] = {
        "NOTIFY_SOCKET",      "LISTEN_FDS",     "LISTEN_PID",    "LISTEN_FDNAMES",           "WATCHDOG_USEC",
        "WATCHDOG_PID",       "JOURNAL_STREAM", "INVOCATION_ID", "CREDENTIALS_DIRECTORY",    "STATE_DIRECTORY",
        "CACHE_DIRECTORY",    "MARCHD_SOCKET",  "SSH_AUTH_SOCK", "DBUS_SESSION_BUS_ADDRESS", "XDG_RUNTIME_DIR",
        "AWS_SECRET_API_KEY", "PATHS",          "LANGUAGE_KEY",
    };
    char **environment;

    for (size_t i = 0; i < sizeof dropped / sizeof dropped[0]; i++)
        assert_int_equal(setenv(dropped[i], "x", 1), 0);
    environment = worker_environment_create(3);
    for (size_t i = 0; i < sizeof dropped / sizeof dropped[0]; i++)
        if (has(environment, dropped[i])) fail_msg("%s is handed on", dropped[i]);
    worker_environment_destroy(environment);
}

static void variables_of_drivers_are_passed_on(void **state)
{
    static const char *const kept[] = {
        "PATH", "HOME", "TMPDIR", "LD_LIBRARY_PATH", "LC_ALL", "GALLIUM_DRIVER", "__EGL_VENDOR_LIBRARY_FILENAMES"};
    char **environment;

    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++)
        assert_int_equal(setenv(kept[i], "/x", 1), 0);
    environment = worker_environment_create(3);
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++)
        if (!has(environment, kept[i])) fail_msg("%s is dropped", kept[i]);
    worker_environment_destroy(environment);
}

static void threads_and_caches_are_set_by_the_daemon(void **state)
{
    char **environment;

    assert_int_equal(setenv("LP_NUM_THREADS", "77", 1), 0);
    assert_int_equal(setenv("MESA_SHADER_CACHE_DISABLE", "false", 1), 0);
    environment = worker_environment_create(3);
    assert_true(has(environment, "LP_NUM_THREADS=3"));
    assert_false(has(environment, "LP_NUM_THREADS=77"));
    assert_true(has(environment, "MESA_SHADER_CACHE_DISABLE=true"));
    assert_false(has(environment, "MESA_SHADER_CACHE_DISABLE=false"));
    assert_true(has(environment, "__GL_SHADER_DISK_CACHE=0"));
    worker_environment_destroy(environment);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(variables_of_the_daemon_and_secrets_are_left_out),
        cmocka_unit_test(variables_of_drivers_are_passed_on),
        cmocka_unit_test(threads_and_caches_are_set_by_the_daemon),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
