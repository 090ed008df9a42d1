// SPDX-License-Identifier: Apache-2.0
#include "daemon/slurm/slurm_text.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define HEADING "JOBID|STATE|NODELIST|TIME_LEFT|NAME|REASON\n"

static void the_id_of_a_job(void **state)
{
    static const char *const wrong[] = {
        "",      "\n",       "12",    "0\n",    "-3\n",          "12 \n",
        "12x\n", "12\n13\n", "x12\n", "\n12\n", "99999999999\n", "Submitted batch job 12\n"};
    int64_t job;

    assert_true(slurm_read_job("12\n", &job, NULL));
    assert_int_equal(job, 12);
    assert_true(slurm_read_job("4294967295;tests\n", &job, NULL));
    assert_true(job == 4294967295);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_false(slurm_read_job(wrong[i], &job, NULL));
}

static void times(void **state)
{
    static const struct {
        const char *text;
        int64_t seconds;
    } right[] = {{"0:00", 0},
                 {"5:07", 307},
                 {"1:00:00", 3600},
                 {"2-12:00:01", 216001},
                 {"UNLIMITED", SLURM_NO_LIMIT},
                 {"NOT_SET", SLURM_NO_LIMIT},
                 {"INVALID", SLURM_NO_LIMIT}};
    static const char *const wrong[] = {"", "5", "5:", ":5", "1:2:3:4", "5:00 ", "-5:00", "x", "1-5", "99999999999:00"};
    int64_t seconds;

    for (size_t i = 0; i < sizeof right / sizeof right[0]; i++) {
        assert_true(slurm_read_time(right[i].text, &seconds, NULL));
        assert_int_equal(seconds, right[i].seconds);
    }
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_false(slurm_read_time(wrong[i], &seconds, NULL));
}

struct taken {
    struct slurm_row rows[4];
    int count;
};

static bool take(void *user, const struct slurm_row *row, struct error *error)
{
    struct taken *taken = user;

    taken->rows[taken->count++] = *row;
    if (taken->count < 4) return true;
    error_set(error, "enough");
    return false;
}

static void rows(void **state)
{
    char *text = xstrdup(HEADING "7|RUNNING|n1|9:59|a.1|None\n"
                                 "8|PENDING||UNLIMITED|a.2|ReqNodeNotAvail, UnavailableNodes:n1|2\n"
                                 "9|NODE_FAIL|n2|0:00|a.3|NodeDown\n");
    struct taken taken = {0};

    assert_true(slurm_read_rows(text, take, &taken, NULL));
    assert_int_equal(taken.count, 3);
    assert_int_equal(taken.rows[0].job, 7);
    assert_int_equal(taken.rows[0].phase, SLURM_RUNS);
    assert_int_equal(taken.rows[0].left_s, 599);
    assert_string_equal(taken.rows[0].machine, "n1");
    assert_string_equal(taken.rows[0].name, "a.1");
    assert_int_equal(taken.rows[1].phase, SLURM_WAITS);
    assert_string_equal(taken.rows[1].machine, "");
    assert_string_equal(taken.rows[1].reason, "ReqNodeNotAvail, UnavailableNodes:n1|2");
    assert_int_equal(taken.rows[2].phase, SLURM_IS_OVER);
    assert_string_equal(taken.rows[2].state, "NODE_FAIL");
    free(text);
    text = xstrdup(HEADING);
    taken.count = 0;
    assert_true(slurm_read_rows(text, take, &taken, NULL));
    assert_int_equal(taken.count, 0);
    free(text);
}

// An answer that is none must not say that there is no job.
static void what_is_no_answer(void **state)
{
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"", "cut off"},
        {"\n", "expected \"JOBID"},
        {"7|RUNNING|n1|9:59|a.1|None\n", "expected \"JOBID"},
        {HEADING "7|RUNNING|n1|9:59|a.1|No", "cut off"},
        {HEADING "7|RUNNING|n1|9:59|a.1\n", "line 2: expected 6 fields"},
        {HEADING "7_3|RUNNING|n1|9:59|a.1|None\n", "line 2: expected a job's id, got \"7_3\""},
        {HEADING "7|RUNNING|n1|soon|a.1|None\n", "line 2: expected a time, got \"soon\""},
        {HEADING "\n", "line 2: expected 6 fields"},
        {HEADING "1|RUNNING||0:01|a|\n1|RUNNING||0:01|a|\n1|X||0:01|a|\n1|RUNNING||0:01|a|\n", "line 5: enough"}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *text = xstrdup(cases[i].text);
        struct taken taken = {0};
        struct error error = {0};

        assert_false(slurm_read_rows(text, take, &taken, &error));
        if (!strstr(error.message, cases[i].expected)) fail_msg("%s", error.message);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_id_of_a_job), cmocka_unit_test(times),
                                       cmocka_unit_test(rows), cmocka_unit_test(what_is_no_answer)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
