// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_set.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static void members_are_found_in_order(void **state)
{
    static const int64_t members[] = {0, 63, 64, 127, 191, 199};
    struct frame_set set;
    int64_t at = -1;

    frame_set_init(&set, 200);
    for (size_t i = 6; i > 0; i--)
        frame_set_add(&set, members[i - 1]);
    for (size_t i = 0; i < 6; i++) {
        assert_int_equal(frame_set_count_from(&set, at + 1), 6 - i);
        at = frame_set_next(&set, at + 1);
        assert_int_equal(at, members[i]);
        assert_true(frame_set_has(&set, at));
    }
    assert_int_equal(frame_set_next(&set, 200), 200);
    assert_int_equal(frame_set_count_from(&set, 200), 0);
    assert_false(frame_set_has(&set, 1) || frame_set_has(&set, -1) || frame_set_has(&set, 200));
    frame_set_finish(&set);
}

static void a_limit_of_whole_words_ends_there(void **state)
{
    struct frame_set set;

    frame_set_init(&set, 128);
    assert_int_equal(frame_set_next(&set, 0), 128);
    assert_int_equal(frame_set_next(&set, 128), 128);
    frame_set_finish(&set);
}

static void a_range_is_read(void **state)
{
    struct frame_set set;
    struct error error = {0};

    assert_true(frame_set_parse(&set, "9-5x2,100", &error));
    assert_int_equal(frame_set_count_from(&set, 0), 4);
    assert_true(frame_set_has(&set, 9) && frame_set_has(&set, 5) && frame_set_has(&set, 100));
    frame_set_finish(&set);
    assert_false(frame_set_parse(&set, "1..9", &error));
    assert_null(set.words);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(members_are_found_in_order),
        cmocka_unit_test(a_limit_of_whole_words_ends_there),
        cmocka_unit_test(a_range_is_read),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
