// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_order.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// The indices in their order, after spaces.
static const char *list(struct frame_order order, int64_t count)
{
    static char text[256];

    text[0] = '\0';
    for (int64_t i = 0; i < frame_order_length(&order, count); i++) {
        int64_t index = frame_order_at(&order, count, i);

        if (index >= 0) sprintf(text + strlen(text), " %d", (int)index);
    }
    return text;
}

static void frames_come_as_written_unless_told_otherwise(void **state)
{
    assert_string_equal(list((struct frame_order){0}, 4), " 0 1 2 3");
}

static void first_last_and_middle_come_before_the_rest(void **state)
{
    struct frame_order order = {{FRAME_ORDER_FIRST, FRAME_ORDER_LAST, FRAME_ORDER_MIDDLE}, 3};

    assert_string_equal(list(order, 8), " 0 7 4 1 2 3 5 6");
    assert_string_equal(list(order, 3), " 0 2 1");
    assert_string_equal(list(order, 2), " 0 1");
    assert_string_equal(list(order, 1), " 0");
}

static void every_nth_comes_before_the_rest(void **state)
{
    assert_string_equal(list((struct frame_order){{4}, 1}, 10), " 0 4 8 1 2 3 5 6 7 9");
    assert_string_equal(list((struct frame_order){{4, 2}, 2}, 9), " 0 4 8 2 6 1 3 5 7");
    assert_string_equal(list((struct frame_order){{100}, 1}, 3), " 0 1 2");
    assert_string_equal(list((struct frame_order){{FRAME_ORDER_LAST, 3}, 2}, 8), " 7 0 3 6 1 2 4 5");
}

static void every_order_has_each_frame_once(void **state)
{
    for (int64_t count = 1; count < 40; count++)
        for (int32_t stage = -2; stage < 12; stage++)
            for (int32_t other = -2; other < 12; other++) {
                struct frame_order order = {{stage, other}, 2};
                char seen[40] = "";

                for (int64_t i = 0; i < frame_order_length(&order, count); i++) {
                    int64_t index = frame_order_at(&order, count, i);

                    assert_true(index >= -1 && index < count);
                    if (index >= 0) assert_int_equal(seen[index]++, 0);
                }
                for (int64_t i = 0; i < count; i++)
                    assert_int_equal(seen[i], 1);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_as_written_unless_told_otherwise),
        cmocka_unit_test(first_last_and_middle_come_before_the_rest),
        cmocka_unit_test(every_nth_comes_before_the_rest),
        cmocka_unit_test(every_order_has_each_frame_once),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
