// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/cursor.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void cursor_reads_back(void **state)
{
    static const int64_t positions[] = {0, 1, 99, INT64_C(1) << 52};

    for (size_t i = 0; i < sizeof positions / sizeof *positions; i++) {
        char text[CURSOR_TEXT_SIZE];
        int64_t position = -1;

        cursor_format(text, CURSOR_JOBS_DOWN, positions[i]);
        assert_true(cursor_parse(text, CURSOR_JOBS_DOWN, &position));
        assert_int_equal(position, positions[i]);
    }
}

static void cursor_of_another_list_is_refused(void **state)
{
    char text[CURSOR_TEXT_SIZE];
    int64_t position;

    cursor_format(text, CURSOR_JOBS_UP, 7);
    assert_false(cursor_parse(text, CURSOR_JOBS_DOWN, &position));
    assert_false(cursor_parse(text, CURSOR_FRAMES, &position));
}

static void anything_else_is_refused(void **state)
{
    static const char *const texts[] = {"",    "u",  "7",    "u-7", "u+7",  "u 7",
                                        "u7 ", "U7", "u0x7", "u7u", "u1e3", "u1234567890123456789"};
    int64_t position;

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        assert_false(cursor_parse(texts[i], CURSOR_JOBS_UP, &position));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cursor_reads_back),
        cmocka_unit_test(cursor_of_another_list_is_refused),
        cmocka_unit_test(anything_else_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
