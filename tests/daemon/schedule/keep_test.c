// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/keep.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { NOW = 100000 };

// By their ends: 4, 2, 1, 3.
static void make_jobs(struct keep_job jobs[static 4])
{
    jobs[0] = (struct keep_job){1, 30000, 100};
    jobs[1] = (struct keep_job){2, 20000, 10};
    jobs[2] = (struct keep_job){3, 40000, 1000};
    jobs[3] = (struct keep_job){4, 20000 - 1, 1};
    keep_sort(jobs, 4);
}

static size_t count_leaving(struct keep_rules rules)
{
    struct keep_job jobs[4];

    make_jobs(jobs);
    return keep_choose(&rules, jobs, 4, NOW).count;
}

static void the_oldest_end_comes_first(void **state)
{
    static const int64_t ids[] = {4, 2, 1, 3};
    struct keep_job jobs[4];

    make_jobs(jobs);
    for (size_t i = 0; i < 4; i++)
        assert_int_equal(jobs[i].id, ids[i]);
}

static void ends_of_one_moment_are_in_the_order_of_ids(void **state)
{
    struct keep_job jobs[] = {{9, 5, 0}, {7, 5, 0}, {8, 5, 0}};

    keep_sort(jobs, 3);
    assert_int_equal(jobs[0].id, 7);
    assert_int_equal(jobs[2].id, 9);
}

static void without_rules_all_stay(void **state)
{
    assert_int_equal(count_leaving((struct keep_rules){0}), 0);
}

static void so_many_jobs_stay(void **state)
{
    assert_int_equal(count_leaving((struct keep_rules){.jobs = 4}), 0);
    assert_int_equal(count_leaving((struct keep_rules){.jobs = 3}), 1);
    assert_int_equal(count_leaving((struct keep_rules){.jobs = 1}), 3);
}

static void a_job_leaves_after_its_time(void **state)
{
    assert_int_equal(count_leaving((struct keep_rules){.ms = NOW}), 0);
    assert_int_equal(count_leaving((struct keep_rules){.ms = NOW - 20000}), 1); // the second is over for just so long
    assert_int_equal(count_leaving((struct keep_rules){.ms = NOW - 20001}), 2);
    assert_int_equal(count_leaving((struct keep_rules){.ms = 1}), 4);
}

static void the_newest_stay_whose_files_fit(void **state)
{
    assert_int_equal(count_leaving((struct keep_rules){.bytes = 1111}), 0);
    assert_int_equal(count_leaving((struct keep_rules){.bytes = 1110}), 1);
    assert_int_equal(count_leaving((struct keep_rules){.bytes = 1000}), 3);
    assert_int_equal(count_leaving((struct keep_rules){.bytes = 999}), 4);
}

static void each_leaves_by_a_rule_that_says_so(void **state)
{
    struct keep_job jobs[4];
    struct keep_choice choice;

    make_jobs(jobs);
    choice = keep_choose(&(struct keep_rules){.ms = NOW - 20000, .jobs = 2, .bytes = 1000}, jobs, 4, NOW);
    assert_int_equal(choice.count, 3);
    assert_string_equal(keep_rule_of(&choice, 0), "keep-days");
    assert_string_equal(keep_rule_of(&choice, 1), "keep-jobs");
    assert_string_equal(keep_rule_of(&choice, 2), "keep-bytes");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_oldest_end_comes_first),
        cmocka_unit_test(ends_of_one_moment_are_in_the_order_of_ids),
        cmocka_unit_test(without_rules_all_stay),
        cmocka_unit_test(so_many_jobs_stay),
        cmocka_unit_test(a_job_leaves_after_its_time),
        cmocka_unit_test(the_newest_stay_whose_files_fit),
        cmocka_unit_test(each_leaves_by_a_rule_that_says_so),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
