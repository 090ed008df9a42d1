#include "cli/socket_path.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_chosen(const struct socket_path_params *params, const char *expected)
{
    char *path = socket_path_choose(params);

    assert_string_equal(path, expected);
    free(path);
}

static void option_wins_over_everything(void **state)
{
    assert_chosen(&(struct socket_path_params){"/o", "/e", "/", "/run/user/1"}, "/o");
}

static void environment_comes_next(void **state)
{
    assert_chosen(&(struct socket_path_params){NULL, "/e", "/", "/run/user/1"}, "/e");
    assert_chosen(&(struct socket_path_params){"", "/e", "/", NULL}, "/e");
}

static void system_socket_is_used_only_if_it_is_there(void **state)
{
    assert_chosen(&(struct socket_path_params){NULL, "", "/", "/run/user/1"}, "/");
    assert_chosen(&(struct socket_path_params){NULL, NULL, "/nowhere/at/all", "/run/user/1"},
                  "/run/user/1/marchd.sock");
}

static void system_socket_is_named_when_nothing_is_there(void **state)
{
    assert_chosen(&(struct socket_path_params){NULL, NULL, "/nowhere/at/all", NULL}, "/nowhere/at/all");
    assert_chosen(&(struct socket_path_params){NULL, NULL, NULL, ""}, SOCKET_PATH_SYSTEM);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(option_wins_over_everything),
        cmocka_unit_test(environment_comes_next),
        cmocka_unit_test(system_socket_is_used_only_if_it_is_there),
        cmocka_unit_test(system_socket_is_named_when_nothing_is_there),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
