// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/index_heap.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void indices_are_taken_in_ascending_order(void **state)
{
    enum { COUNT = 1000 };
    struct index_heap heap = {0};
    int32_t index;

    for (int32_t i = 0; i < COUNT; i++)
        index_heap_add(&heap, (int32_t)((int64_t)i * 617 % COUNT)); // coprime to 1000: each index once
    for (int32_t i = 0; i < COUNT; i++) {
        assert_true(index_heap_take(&heap, &index));
        assert_int_equal(index, i);
    }
    assert_false(index_heap_take(&heap, &index));
    index_heap_finish(&heap);
}

static void adding_between_taking_keeps_the_order(void **state)
{
    struct index_heap heap = {0};
    int32_t index;

    index_heap_add(&heap, 5);
    index_heap_add(&heap, 3);
    assert_true(index_heap_take(&heap, &index));
    assert_int_equal(index, 3);
    index_heap_add(&heap, 1);
    index_heap_add(&heap, 9);
    for (int32_t expected = 1; expected <= 9; expected += 4) {
        assert_true(index_heap_take(&heap, &index));
        assert_int_equal(index, expected);
    }
    index_heap_finish(&heap);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(indices_are_taken_in_ascending_order),
        cmocka_unit_test(adding_between_taking_keeps_the_order),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
