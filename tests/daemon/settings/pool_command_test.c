// The words by which a command of a pool is asked for, and those that ask for nothing that the pool may run.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/pool_command.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/settings/pool_options.h"
#include "daemon/settings/slurm_commands.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
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

#define FARM "0123456789abcdef0123456789abcdef"
#define POOL "p launcher=slurm max=2 partition=gpu time=1:00:00 arguments=--qos=low keep=30 workers=2"

static void assert_command(const char *const words[], const char *const expected[])
{
    struct pool_options pool;
    char **command;
    size_t count = 0;

    assert_true(pool_options_read(&pool, POOL, NULL));
    command = pool_command_make(&pool, words, NULL);
    assert_non_null(command);
    for (; expected[count]; count++) {
        assert_non_null(command[count]);
        assert_string_equal(command[count], expected[count]);
    }
    assert_null(command[count]);
    pool_options_free_command(command);
    pool_options_finish(&pool);
}

// Each by the name of the allocation, whatever id it has.
static void commands_of_slurm(void **state)
{
    struct pool_options pool;
    char **look;

    assert_true(pool_options_read(&pool, POOL, NULL));
    look = pool_command_make(&pool, (const char *const[]){"look", FARM, NULL}, NULL);
    assert_non_null(look);
    assert_string_equal(look[0], "squeue");
    assert_string_equal(look[1], "--me");
    assert_non_null(strstr(look[4], "--name=march-0123456789ab-p.1,march-0123456789ab-p.2,"));
    assert_non_null(strstr(look[4], ",march-0123456789ab-p.256"));
    pool_options_free_command(look);
    pool_options_finish(&pool);
    assert_command((const char *const[]){"cancel", FARM, "2", "77", NULL},
                   (const char *const[]){"scancel", "--me", "--name=march-0123456789ab-p.2", "77", NULL});
    assert_command((const char *const[]){"step", "77", NULL},
                   (const char *const[]){"srun", "--jobid=77", "--exact", "--quiet", "--mpi=none", "--nodes=1",
                                         "--ntasks=1", "--chdir=/", "--cpus-per-task=2", "march-worker", "--node",
                                         NULL});
}

static void what_is_asked_of_slurm(void **state)
{
    char *script = slurm_commands_format_script("/out/it's/x", 30000), *wrap = xasprintf("--wrap=%s", script);

    assert_memory_equal(script, "lease='/out/it'\\''s/x'\n", 23);
    assert_non_null(strstr(script, "-lt 30 ]"));
    assert_non_null(strstr(script, "sleep 3\n"));
    assert_command((const char *const[]){"ask", FARM, "1", "/out/it's/x", NULL},
                   (const char *const[]){"sbatch", "--parsable", "--no-requeue", "--nodes=1", "--ntasks=1", "--chdir=/",
                                         "--input=/dev/null", "--output=/dev/null", "--error=/dev/null",
                                         "--cpus-per-task=2", "--job-name=march-0123456789ab-p.1", "--partition=gpu",
                                         "--time=1:00:00", "--qos=low", wrap, NULL});
    free(script);
    free(wrap);
}

static void what_slurm_is_not_asked(void **state)
{
    static const struct {
        const char *words[5];
        const char *expected;
    } cases[] = {
        {{"node", "p.1", NULL}, "pool p runs no command \"node\" with 1 arguments"},
        {{"step", "0", NULL}, "expected a number from 1 to 4294967295, got \"0\""},
        {{"step", "7 --x", NULL}, "expected a number from 1 to 4294967295, got \"7 --x\""},
        {{"step", "-7", NULL}, "expected a number from 1 to 4294967295, got \"-7\""},
        {{"look", "x", NULL}, "expected the id of a farm, got \"x\""},
        {{"ask", FARM, "3", "/x", NULL}, "expected a number from 1 to 2, got \"3\""},
        {{"ask", FARM, "1", "x", NULL}, "expected an absolute path, got \"x\""},
        {{"cancel", FARM, "1", "", NULL}, "expected a number from 1 to 4294967295, got \"\""},
    };
    struct pool_options pool;

    assert_true(pool_options_read(&pool, POOL, NULL));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct error error = {0};

        assert_null(pool_command_make(&pool, cases[i].words, &error));
        assert_string_equal(error.message, cases[i].expected);
    }
    pool_options_finish(&pool);
    assert_true(pool_options_read(&pool, "p nodes=anna command=x", NULL));
    assert_null(pool_command_make(&pool, (const char *const[]){"step", "7", NULL}, NULL));
    pool_options_finish(&pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_node_is_started_by_its_pools_command),
        cmocka_unit_test(other_words_ask_for_nothing),
        cmocka_unit_test(commands_of_slurm),
        cmocka_unit_test(what_is_asked_of_slurm),
        cmocka_unit_test(what_slurm_is_not_asked),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
