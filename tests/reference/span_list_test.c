// SPDX-License-Identifier: Apache-2.0
#include "reference/span_list.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void empty_spans_are_dropped(void **state)
{
    struct span_list list = {0};

    span_list_append(&list, 1.0, 1.0, NULL);
    span_list_append(&list, 2.0, 1.0, NULL);
    assert_int_equal(list.count, 0);
}

static void a_split_keeps_what_is_covered(void **state)
{
    struct span_list list = {0};

    span_list_append(&list, 0.0, 1.0, NULL);
    span_list_append(&list, 2.0, 3.0, NULL);
    span_list_split(&list, 1.5);
    span_list_split(&list, 2.0);
    assert_int_equal(list.count, 2);
    span_list_split(&list, 2.25);
    assert_int_equal(list.count, 3);
    assert_true(list.spans[1].begin == 2.0 && list.spans[1].end == 2.25);
    assert_true(list.spans[2].begin == 2.25 && list.spans[2].end == 3.0);
    span_list_finish(&list);
}

static void a_merge_covers_both_and_cuts_at_every_end(void **state)
{
    static const double WANTED[][2] = {{0.0, 0.5}, {0.5, 1.0}, {1.0, 2.0}, {3.0, 4.0}};
    struct span_list list = {0}, other = {0};

    span_list_append(&list, 0.0, 1.0, NULL);
    span_list_append(&list, 3.0, 4.0, NULL);
    span_list_append(&other, 0.5, 2.0, NULL);
    span_list_merge(&list, &other);
    assert_int_equal(list.count, 4);
    for (size_t i = 0; i < 4; i++) {
        assert_true(list.spans[i].begin == WANTED[i][0]);
        assert_true(list.spans[i].end == WANTED[i][1]);
    }
    span_list_finish(&list);
    span_list_finish(&other);
}

static void a_list_grows_with_what_is_appended(void **state)
{
    enum { COUNT = 5000 };
    struct span_list list = {0};

    for (int i = 0; i < COUNT; i++)
        span_list_append(&list, i, i + 0.5, NULL);
    assert_int_equal(list.count, COUNT);
    for (int i = 0; i < COUNT; i++)
        assert_true(list.spans[i].begin == i && list.spans[i].end == i + 0.5);
    span_list_finish(&list);
    assert_int_equal(list.count, 0);
}

static void an_end_may_be_infinite(void **state)
{
    struct span_list list = {0}, other = {0};

    span_list_append(&list, 1.0, INFINITY, NULL);
    span_list_append(&other, 0.0, 2.0, NULL);
    span_list_append(&other, 3.0, INFINITY, NULL);
    span_list_merge(&list, &other);
    assert_int_equal(list.count, 4);
    assert_true(list.spans[0].begin == 0.0 && list.spans[1].begin == 1.0 && list.spans[2].begin == 2.0);
    assert_true(list.spans[3].begin == 3.0 && isinf(list.spans[3].end));
    span_list_split(&list, NAN);
    span_list_split(&list, INFINITY);
    span_list_split(&list, -INFINITY);
    assert_int_equal(list.count, 4);
    span_list_finish(&list);
    span_list_finish(&other);
}

static void splits_at_anothers_ends_cover_no_more(void **state)
{
    struct span_list list = {0}, other = {0};

    span_list_append(&list, 0.0, 1.0, NULL);
    span_list_append(&list, 2.0, 3.0, NULL);
    span_list_append(&other, 0.5, 2.5, NULL);
    span_list_split_at_ends(&list, &other);
    assert_int_equal(list.count, 4);
    assert_true(list.spans[1].begin == 0.5 && list.spans[1].end == 1.0);
    assert_true(list.spans[2].begin == 2.0 && list.spans[2].end == 2.5);
    span_list_finish(&list);
    span_list_finish(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(empty_spans_are_dropped),
        cmocka_unit_test(a_split_keeps_what_is_covered),
        cmocka_unit_test(a_merge_covers_both_and_cuts_at_every_end),
        cmocka_unit_test(a_list_grows_with_what_is_appended),
        cmocka_unit_test(an_end_may_be_infinite),
        cmocka_unit_test(splits_at_anothers_ends_cover_no_more),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
