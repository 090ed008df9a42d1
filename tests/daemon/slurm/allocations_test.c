// SPDX-License-Identifier: Apache-2.0
#include "daemon/slurm/allocations.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define IDLE_MS 60000

static struct allocations allocations;

static int set_up(void **state)
{
    allocations_init(&allocations, "march-x-far", 3);
    return 0;
}

static int tear_down(void **state)
{
    allocations_finish(&allocations);
    return 0;
}

static void answer(const char *rows, int64_t asked_ms)
{
    char *text = xasprintf("JOBID|STATE|NODELIST|TIME_LEFT|NAME|REASON\n%s", rows);

    assert_true(allocations_take_answer(&allocations, text, asked_ms, NULL));
    free(text);
}

static void assert_state(int index, enum allocation_state state, int64_t job, const char *reason)
{
    const struct allocation *allocation = &allocations.all[index];

    assert_int_equal(allocation->state, state);
    assert_int_equal(allocation->job, job);
    if (reason)
        assert_string_equal(allocation->reason, reason);
    else
        assert_null(allocation->reason);
}

static void how_many(void **state)
{
    assert_int_equal(allocations_want(0, 4, 0, 3), 0);
    assert_int_equal(allocations_want(0, 4, 1, 3), 1);
    assert_int_equal(allocations_want(5, 4, 0, 3), 2);
    assert_int_equal(allocations_want(INT64_C(1) << 40, 4, 0, 3), 3);
}

// Nothing is asked for before Slurm has said what is there, and no more than is wanted.
static void asks_for_what_lacks(void **state)
{
    assert_int_equal(allocations_find_to_ask(&allocations, 3), -1);
    answer("", 0);
    assert_int_equal(allocations_find_to_ask(&allocations, 0), -1);
    assert_int_equal(allocations_find_to_ask(&allocations, 2), 0);
    allocations_note_asked(&allocations, 0);
    assert_int_equal(allocations_find_to_ask(&allocations, 2), -1);
    allocations_note_job(&allocations, 0, 7, 100);
    assert_state(0, ALLOCATION_WAITS, 7, "Slurm's job 7 waits");
    assert_int_equal(allocations_find_to_ask(&allocations, 1), -1);
    assert_int_equal(allocations_find_to_ask(&allocations, 2), 1);
    answer("7|PENDING||1:00:00|march-x-far.1|Resources\n", 200);
    assert_state(0, ALLOCATION_WAITS, 7, "Slurm's job 7 waits: Resources");
    answer("7|RUNNING|n2|1:00:00|march-x-far.1|None\n", 300);
    assert_state(0, ALLOCATION_RUNS, 7, NULL);
    assert_string_equal(allocations.all[0].machine, "n2");
    assert_true(allocations.all[0].end_ms == 300 + 3600000 && allocations.all[0].whole_ms == 3600000);
    answer("7|RUNNING|n2|30:00|march-x-far.1|None\n", 1800300);
    assert_true(allocations.all[0].end_ms == 300 + 3600000 && allocations.all[0].whole_ms == 3600000);
}

// What a daemon before has asked for is found by its name.
static void finds_what_is_there(void **state)
{
    answer("9|RUNNING|n3|UNLIMITED|march-x-far.3|None\n", 5);
    assert_state(2, ALLOCATION_RUNS, 9, NULL);
    assert_int_equal(allocations.all[2].end_ms, 0);
    assert_int_equal(allocations_find_to_ask(&allocations, 1), -1);
    assert_int_equal(allocations_find_to_ask(&allocations, 2), 0);
}

// sbatch said nothing: whether Slurm has it is known only a while later, and until then nothing is asked for.
static void silence_is_no_refusal(void **state)
{
    answer("", 0);
    allocations_note_asked(&allocations, 0);
    allocations_note_silence(&allocations, 0, "sbatch: no answer", 1000);
    answer("", 2000);
    assert_state(0, ALLOCATION_ASKED, 0, "sbatch: no answer");
    assert_int_equal(allocations_find_to_ask(&allocations, 3), -1);
    answer("7|PENDING||1:00|march-x-far.1|None\n", 3000);
    assert_state(0, ALLOCATION_WAITS, 7, "Slurm's job 7 waits: None");

    allocations_note_asked(&allocations, 1);
    allocations_note_silence(&allocations, 1, "sbatch: no answer", 3000);
    answer("7|PENDING||1:00|march-x-far.1|None\n", 13000);
    assert_state(1, ALLOCATION_NONE, 0, "sbatch: no answer");
    assert_int_equal(allocations_find_to_ask(&allocations, 2), 1);
}

static void the_end_has_its_reason(void **state)
{
    answer("7|RUNNING|n1|1:00|march-x-far.1|None\n8|RUNNING|n2|1:00|march-x-far.2|None\n"
           "9|RUNNING|n3|1:00|march-x-far.3|None\n",
           0);
    answer("7|NODE_FAIL|n1|0:00|march-x-far.1|NodeDown\n8|COMPLETING|n2|0:10|march-x-far.2|None\n", 10);
    assert_state(0, ALLOCATION_NONE, 0, "Slurm's job 7 on n1 ended: NODE_FAIL (NodeDown)");
    assert_state(1, ALLOCATION_NONE, 0, "Slurm's job 8 on n2 ended: COMPLETING");
    assert_state(2, ALLOCATION_NONE, 0, "Slurm knows no job 9 any more");
    answer("8|TIMEOUT|n2|0:00|march-x-far.2|TimeLimit\n", 20);
    assert_state(1, ALLOCATION_NONE, 0, "Slurm's job 8 on n2 ended: TIMEOUT (TimeLimit)");
    // An older end of the same name is no end of the present job.
    allocations_note_asked(&allocations, 1);
    allocations_note_job(&allocations, 1, 11, 30);
    answer("8|TIMEOUT|n2|0:00|march-x-far.2|TimeLimit\n11|RUNNING|n2|1:00|march-x-far.2|None\n", 40);
    assert_state(1, ALLOCATION_RUNS, 11, NULL);
}

// Slurm may give an id to a job of another name; and two jobs of one name are one too many.
static void ids_are_not_believed(void **state)
{
    answer("7|RUNNING|n1|1:00|march-x-far.1|None\n", 0);
    answer("7|RUNNING|n1|1:00|march-x-far.2|None\n", 10);
    assert_state(0, ALLOCATION_NONE, 0, "Slurm knows no job 7 any more");
    assert_state(1, ALLOCATION_RUNS, 7, NULL);
    answer("6|PENDING||1:00|march-x-far.2|None\n7|RUNNING|n1|1:00|march-x-far.2|None\n", 20);
    assert_state(1, ALLOCATION_RUNS, 7, NULL);
    assert_int_equal(allocations.surplus_job, 6);
    assert_int_equal(allocations.surplus_index, 1);
    answer("7|RUNNING|n1|1:00|march-x-far.2|None\n8|PENDING||1:00|march-x-far.2|None\n", 30);
    assert_state(1, ALLOCATION_RUNS, 7, NULL);
    assert_int_equal(allocations.surplus_job, 8);
    answer("7|RUNNING|n1|1:00|march-x-far.2|None\n", 40);
    assert_int_equal(allocations.surplus_job, 0);
}

static void no_answer_changes_nothing(void **state)
{
    static const char *const wrong[] = {"8|RUNNING|n1|1:00|other|None\n", "8|RUNNING|n1|1:00|march-x-far.0|None\n",
                                        "8|RUNNING|n1|1:00|march-x-far.1x|None\n",
                                        "7|TIMEOUT|n1|x|march-x-far.1|None\n"};

    answer("7|RUNNING|n1|1:00|march-x-far.1|None\n", 0);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char *text =
            xasprintf("JOBID|STATE|NODELIST|TIME_LEFT|NAME|REASON\n7|TIMEOUT|n1|0:00|march-x-far.1|x\n%s", wrong[i]);

        assert_false(allocations_take_answer(&allocations, text, 10, NULL));
        assert_state(0, ALLOCATION_RUNS, 7, NULL);
        free(text);
    }
}

static void gives_back_what_was_allowed_before(void **state)
{
    answer("7|RUNNING|n1|1:00|march-x-far.1|None\n8|RUNNING|n2|1:00|march-x-far.9|None\n", 0);
    assert_int_equal(allocations.surplus_job, 8);
    assert_int_equal(allocations.surplus_index, 8);
    assert_state(0, ALLOCATION_RUNS, 7, NULL);
    answer("7|RUNNING|n1|1:00|march-x-far.1|None\n8|CANCELLED|n2|1:00|march-x-far.9|None\n", 10);
    assert_int_equal(allocations.surplus_job, 0);
}

static void gives_back_what_is_too_much(void **state)
{
    answer("7|RUNNING|n1|1:00:00|march-x-far.1|None\n8|RUNNING|n2|1:00:00|march-x-far.2|None\n"
           "9|PENDING||1:00:00|march-x-far.3|None\n",
           0);
    assert_int_equal(allocations_find_to_cancel(&allocations, 3, IDLE_MS, IDLE_MS), -1);
    assert_int_equal(allocations_find_to_cancel(&allocations, 2, IDLE_MS, 1), 2);
    allocations_note_canceled(&allocations, 2, "no frame waits for it", 1);
    assert_int_equal(allocations_find_to_cancel(&allocations, 1, IDLE_MS, IDLE_MS - 1), 2);
    answer("7|RUNNING|n1|1:00:00|march-x-far.1|None\n8|RUNNING|n2|1:00:00|march-x-far.2|None\n"
           "9|CANCELLED||1:00:00|march-x-far.3|None\n",
           2);
    assert_state(2, ALLOCATION_NONE, 0, "no frame waits for it");
    assert_int_equal(allocations_find_to_cancel(&allocations, 1, IDLE_MS, IDLE_MS - 1), -1);
    allocations.all[1].busy_ms = 10;
    assert_int_equal(allocations_find_to_cancel(&allocations, 1, IDLE_MS, IDLE_MS), 0);
    allocations_note_canceled(&allocations, 0, "no frame waits for it", IDLE_MS);
    assert_int_equal(allocations_find_to_cancel(&allocations, 1, IDLE_MS, IDLE_MS + 1), -1);
    // One that stays is canceled again.
    assert_int_equal(allocations_find_to_cancel(&allocations, 1, IDLE_MS, IDLE_MS + 10000), 0);
    assert_int_equal(allocations_find_to_ask(&allocations, 2), 2);
    // So is one of no more use, however many are wanted.
    allocations.all[1].is_short = true;
    assert_int_equal(allocations_find_to_cancel(&allocations, 3, IDLE_MS, IDLE_MS + 2), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(how_many, set_up, tear_down),
        cmocka_unit_test_setup_teardown(asks_for_what_lacks, set_up, tear_down),
        cmocka_unit_test_setup_teardown(finds_what_is_there, set_up, tear_down),
        cmocka_unit_test_setup_teardown(silence_is_no_refusal, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_end_has_its_reason, set_up, tear_down),
        cmocka_unit_test_setup_teardown(ids_are_not_believed, set_up, tear_down),
        cmocka_unit_test_setup_teardown(no_answer_changes_nothing, set_up, tear_down),
        cmocka_unit_test_setup_teardown(gives_back_what_was_allowed_before, set_up, tear_down),
        cmocka_unit_test_setup_teardown(gives_back_what_is_too_much, set_up, tear_down)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
