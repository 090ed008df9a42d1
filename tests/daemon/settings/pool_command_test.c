// The words by which a command of a pool is asked for, and those that ask for nothing that the pool may run.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/pool_command.h"

#include "core/base/error.h"
#include "daemon/settings/pool_options.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static void a_node_is_started_by_its_pools_command(void **state)
{
    struct pool_options pool;
    char **command;

    assert_true(pool_options_read(&pool, "p nodes=anna,ben command='run {node} --node'", NULL));
    command = pool_command_make(&pool, (const char *const[]){"node", "ben", NULL}, NULL);
    assert_non_null(command);
    assert_string_equal(command[0], "run");
    assert_string_equal(command[1], "ben");
    assert_string_equal(command[2], "--node");
    assert_null(command[3]);
    pool_options_free_command(command);
    pool_options_finish(&pool);
}

static void other_words_ask_for_nothing(void **state)
{
    static const struct {
        const char *words[4];
        const char *expected;
    } cases[] = {
        {{NULL}, "pool p runs no command \"\" with 0 arguments"},
        {{"node", NULL}, "pool p runs no command \"node\" with 0 arguments"},
        {{"node", "anna", "ben", NULL}, "pool p runs no command \"node\" with 2 arguments"},
        {{"nodes", "anna", NULL}, "pool p runs no command \"nodes\" with 1 arguments"},
        {{"node", "dora", NULL}, "pool p has no node dora"},
        {{"node", "", NULL}, "pool p has no node "},
        {{"node", "{node}", NULL}, "pool p has no node {node}"},
    };
    struct pool_options pool;

    assert_true(pool_options_read(&pool, "p nodes=anna,ben command='run {node} --node'", NULL));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct error error = {0};

        assert_null(pool_command_make(&pool, cases[i].words, &error));
        assert_string_equal(error.message, cases[i].expected);
    }
    pool_options_finish(&pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_node_is_started_by_its_pools_command),
        cmocka_unit_test(other_words_ask_for_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
