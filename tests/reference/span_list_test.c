#include "reference/span_list.h"

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
}

static void a_full_list_still_covers_what_is_appended(void **state)
{
    struct span_list list = {0};

    for (int i = 0; i < SPAN_LIMIT + 10; i++)
        span_list_append(&list, i, i + 0.5, NULL);
    assert_int_equal(list.count, SPAN_LIMIT);
    assert_true(list.spans[SPAN_LIMIT - 1].end == SPAN_LIMIT + 9.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(empty_spans_are_dropped),
        cmocka_unit_test(a_split_keeps_what_is_covered),
        cmocka_unit_test(a_merge_covers_both_and_cuts_at_every_end),
        cmocka_unit_test(a_full_list_still_covers_what_is_appended),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
