// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/socket_path.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// `second` NULL: there is only one path.
static void assert_chosen(const struct socket_path_params *params, const char *first, const char *second)
{
    struct socket_path_list list;

    socket_path_choose(&list, params);
    assert_int_equal(list.count, second ? 2 : 1);
    assert_string_equal(list.paths[0], first);
    if (second) assert_string_equal(list.paths[1], second);
    socket_path_finish(&list);
}

static void option_wins_over_everything(void **state)
{
    assert_chosen(&(struct socket_path_params){"/o", "/e", "/s", "/run/user/1", NULL, "/home/a"}, "/o", NULL);
}

static void environment_comes_next(void **state)
{
    assert_chosen(&(struct socket_path_params){NULL, "/e", "/s", "/run/user/1", NULL, NULL}, "/e", NULL);
    assert_chosen(&(struct socket_path_params){"", "/e", "/s", NULL, NULL, NULL}, "/e", NULL);
}

static void system_comes_before_the_users_own(void **state)
{
    assert_chosen(&(struct socket_path_params){NULL, "", "/s", "/run/user/1", NULL, NULL}, "/s",
                  "/run/user/1/marchd.sock");
    assert_chosen(&(struct socket_path_params){NULL, NULL, "/s", NULL, NULL, NULL}, "/s", NULL);
}

static void users_own_is_in_the_state_folder_without_a_runtime_folder(void **state)
{
    assert_chosen(&(struct socket_path_params){NULL, NULL, "/s", "", "/state", "/home/a"}, "/s",
                  "/state/marchd/marchd.sock");
    assert_chosen(&(struct socket_path_params){NULL, NULL, "/s", NULL, "", "/home/a"}, "/s",
                  "/home/a/.local/state/marchd/marchd.sock");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(option_wins_over_everything),
        cmocka_unit_test(environment_comes_next),
        cmocka_unit_test(system_comes_before_the_users_own),
        cmocka_unit_test(users_own_is_in_the_state_folder_without_a_runtime_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
