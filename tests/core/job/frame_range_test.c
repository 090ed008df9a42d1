// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_range.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_frames(const char *text, const int32_t *frames, size_t count)
{
    struct frame_range range;
    struct error error = {0};

    if (!frame_range_parse(&range, text, &error)) fail_msg("%s: %s", text, error.message);
    assert_int_equal(frame_range_count(&range), count);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(frame_range_at(&range, (int64_t)i), frames[i]);
        assert_int_equal(frame_range_index(&range, frames[i]), i);
    }
    frame_range_finish(&range);
}

#define ASSERT_FRAMES(text, ...)                                                                                       \
    assert_frames(text, (const int32_t[]){__VA_ARGS__}, sizeof((const int32_t[]){__VA_ARGS__}) / sizeof(int32_t))

static void assert_refused(const char *text, const char *expected)
{
    struct frame_range range = {.span_count = 1};
    struct error error = {0};

    assert_false(frame_range_parse(&range, text, &error));
    assert_string_equal(error.message, expected);
    assert_int_equal(frame_range_count(&range), 0);
    assert_null(range.spans);
    assert_false(frame_range_parse(&range, text, NULL));
}

static void parts_are_read_in_the_users_order(void **state)
{
    ASSERT_FRAMES("7", 7);
    ASSERT_FRAMES("0", 0);
    ASSERT_FRAMES("1-4", 1, 2, 3, 4);
    ASSERT_FRAMES("1,5,10-12", 1, 5, 10, 11, 12);
    ASSERT_FRAMES("10-12,1", 10, 11, 12, 1);
    ASSERT_FRAMES("9999999", 9999999);
}

static void step_ends_at_or_before_the_last_number(void **state)
{
    ASSERT_FRAMES("1-9x2", 1, 3, 5, 7, 9);
    ASSERT_FRAMES("1-10x3", 1, 4, 7, 10);
    ASSERT_FRAMES("1-9x3", 1, 4, 7);
    ASSERT_FRAMES("1-9x100", 1);
    ASSERT_FRAMES("5-5", 5);
    ASSERT_FRAMES("5-5x3", 5);
}

static void larger_first_number_counts_down(void **state)
{
    ASSERT_FRAMES("4-1", 4, 3, 2, 1);
    ASSERT_FRAMES("9-1x3", 9, 6, 3);
    ASSERT_FRAMES("3-0", 3, 2, 1, 0);
}

static void spaces_around_parts_are_allowed(void **state)
{
    ASSERT_FRAMES(" 1 , 3-4\t,6 ", 1, 3, 4, 6);
}

static void frame_named_twice_keeps_its_first_place(void **state)
{
    ASSERT_FRAMES("3,1-5", 3, 1, 2, 4, 5);
    ASSERT_FRAMES("1-5,3,2", 1, 2, 3, 4, 5);
    ASSERT_FRAMES("5-7,1-9", 5, 6, 7, 1, 2, 3, 4, 8, 9);
    ASSERT_FRAMES("2-8x2,1-9", 2, 4, 6, 8, 1, 3, 5, 7, 9);
    ASSERT_FRAMES("1-9x4,9-1x2", 1, 5, 9, 7, 3);
    ASSERT_FRAMES("7,7,7", 7);
    ASSERT_FRAMES("1-3,1-3,3-1", 1, 2, 3);
}

static void wrong_parts_are_named(void **state)
{
    assert_refused("1..9", "expected \"1-100x2\", got \"1..9\"");
    assert_refused("1-3,4-,9", "expected \"1-100x2\", got \"4-\"");
    assert_refused("", "expected \"1-100x2\", got \"\"");
    assert_refused("1,,2", "expected \"1-100x2\", got \"\"");
    assert_refused("1,2,", "expected \"1-100x2\", got \"\"");
    assert_refused(",1", "expected \"1-100x2\", got \"\"");
    assert_refused("1 - 3", "expected \"1-100x2\", got \"1 - 3\"");
    assert_refused("5x2", "expected \"1-100x2\", got \"5x2\"");
    assert_refused("1-5x", "expected \"1-100x2\", got \"1-5x\"");
    assert_refused("1-5x2x3", "expected \"1-100x2\", got \"1-5x2x3\"");
    assert_refused("+1", "expected \"1-100x2\", got \"+1\"");
    assert_refused("0x10", "expected \"1-100x2\", got \"0x10\"");
    assert_refused("a\n\033[2J", "expected \"1-100x2\", got \"a??[2J\"");
    assert_refused("1-5x0", "expected a step of at least 1, got \"1-5x0\"");
}

static void colon_is_refused_with_a_hint(void **state)
{
    assert_refused("1-10:2", "expected \"1-100x2\", got \"1-10:2\" (a step is written with x, not with a colon)");
}

static void numbers_outside_the_limits_are_refused(void **state)
{
    assert_refused("-5", "expected numbers from 0 to 9999999, got \"-5\"");
    assert_refused("10000000", "expected numbers from 0 to 9999999, got \"10000000\"");
    assert_refused("1-99999999999999999999", "expected numbers from 0 to 9999999, got \"1-99999999999999999999\"");
    assert_refused("1-2x18446744073709551617", "expected numbers from 0 to 9999999, got \"1-2x18446744073709551617\"");
    assert_refused("1-5--7", "expected \"1-100x2\", got \"1-5--7\"");
}

static void limits_in_messages_are_the_constants(void **state)
{
    struct frame_range range;
    struct error error = {0};
    char number[32];

    snprintf(number, sizeof number, " %d,", FRAME_NUMBER_LIMIT - 1);
    assert_false(frame_range_parse(&range, "-1", &error));
    assert_non_null(strstr(error.message, number));
    snprintf(number, sizeof number, " %d ", FRAME_COUNT_LIMIT);
    assert_false(frame_range_parse(&range, "0-9999999", &error));
    assert_non_null(strstr(error.message, number));
}

static void range_holds_at_most_the_limit(void **state)
{
    struct frame_range range;

    assert_true(frame_range_parse(&range, "0-3999999", NULL));
    assert_int_equal(frame_range_count(&range), FRAME_COUNT_LIMIT);
    frame_range_finish(&range);
    assert_refused("0-4000000", "expected at most 4000000 frames in all, got \"0-4000000\"");
    assert_refused("0-2000000,3000000-5000000", "expected at most 4000000 frames in all, got \"3000000-5000000\"");
    assert_refused("1-3000000,1-3000000", "expected at most 4000000 frames in all, got \"1-3000000\"");
}

static void long_parts_are_shortened_in_messages(void **state)
{
    char text[201];

    memset(text, 'z', 200);
    text[200] = '\0';
    assert_refused(text, "expected \"1-100x2\", got \"zzzzzzzzzzzzzzzzzzzzzzzzzzzzzzzzzzzzzzzz...\"");
}

static void frames_not_in_the_range_have_no_index(void **state)
{
    struct frame_range range;

    assert_true(frame_range_parse(&range, "10-20x2,50", NULL));
    assert_int_equal(frame_range_index(&range, 11), -1);
    assert_int_equal(frame_range_index(&range, 9), -1);
    assert_int_equal(frame_range_index(&range, 22), -1);
    assert_int_equal(frame_range_index(&range, -10), -1);
    assert_int_equal(frame_range_index(&range, INT32_MAX), -1);
    frame_range_finish(&range);
    assert_int_equal(frame_range_index(&range, 10), -1);
}

static void many_spans_are_indexed_both_ways(void **state)
{
    enum { COUNT = 100 * 1000 };
    char *text = malloc(COUNT * 9);
    char *end = text;
    struct frame_range range;

    assert_non_null(text);
    // Every third number in an order that jumps: 61 and COUNT have no common divisor.
    for (int i = 0; i < COUNT; i++)
        end += sprintf(end, "%s%d", i ? "," : "", (int)((int64_t)i * 61 % COUNT) * 3);
    assert_true(frame_range_parse(&range, text, NULL));
    assert_int_equal(frame_range_count(&range), COUNT);
    for (int i = 0; i < COUNT; i++) {
        int32_t frame = (int32_t)((int64_t)i * 61 % COUNT) * 3;

        assert_true(frame_range_at(&range, i) == frame);
        assert_true(frame_range_index(&range, frame) == i);
        assert_true(frame_range_index(&range, frame + 1) == -1);
    }
    frame_range_finish(&range);
    free(text);
}

static void overlapping_steps_agree_with_a_plain_list(void **state)
{
    static const char text[] = "100-0x7,3-90x3,50,0-100x5,99-1x2,10-20,0-100";
    enum { FIRST = 0, LAST = 100 };
    static const int parts[][3] = {{100, 0, -7}, {3, 90, 3},  {50, 50, 1}, {0, 100, 5},
                                   {99, 1, -2},  {10, 20, 1}, {0, 100, 1}};
    bool seen[LAST + 1] = {false};
    int64_t count = 0;
    struct frame_range range;

    assert_true(frame_range_parse(&range, text, NULL));
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        int step = parts[i][2];

        for (int frame = parts[i][0]; step > 0 ? frame <= parts[i][1] : frame >= parts[i][1]; frame += step) {
            if (seen[frame]) continue;
            seen[frame] = true;
            assert_int_equal(frame_range_at(&range, count), frame);
            assert_int_equal(frame_range_index(&range, frame), count);
            count++;
        }
    }
    assert_int_equal(frame_range_count(&range), count);
    frame_range_finish(&range);
}

static void formatted_text_parses_back(void **state)
{
    static const char *const texts[] = {"7",     "1-100x2,140", "100-1x3",           "1,5,10-20",
                                        "3,1-5", "2-8x2,1-9",   "9-1,0-9999999x1000"};

    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct frame_range range, again;
        char *text;

        assert_true(frame_range_parse(&range, texts[i], NULL));
        text = frame_range_format(&range);
        assert_true(frame_range_parse(&again, text, NULL));
        assert_int_equal(frame_range_count(&again), frame_range_count(&range));
        for (int64_t k = 0; k < frame_range_count(&range); k++)
            assert_int_equal(frame_range_at(&again, k), frame_range_at(&range, k));
        free(text);
        frame_range_finish(&range);
        frame_range_finish(&again);
    }
}

static void format_is_the_notation_users_write(void **state)
{
    struct frame_range range;
    char *text;

    assert_true(frame_range_parse(&range, " 1-99x2 , 140, 9-5,4-4", NULL));
    text = frame_range_format(&range);
    assert_string_equal(text, "1-99x2,140,8-6x2,4");
    free(text);
    frame_range_finish(&range);
    text = frame_range_format(&range);
    assert_string_equal(text, "");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_read_in_the_users_order),
        cmocka_unit_test(step_ends_at_or_before_the_last_number),
        cmocka_unit_test(larger_first_number_counts_down),
        cmocka_unit_test(spaces_around_parts_are_allowed),
        cmocka_unit_test(frame_named_twice_keeps_its_first_place),
        cmocka_unit_test(wrong_parts_are_named),
        cmocka_unit_test(colon_is_refused_with_a_hint),
        cmocka_unit_test(numbers_outside_the_limits_are_refused),
        cmocka_unit_test(limits_in_messages_are_the_constants),
        cmocka_unit_test(range_holds_at_most_the_limit),
        cmocka_unit_test(long_parts_are_shortened_in_messages),
        cmocka_unit_test(frames_not_in_the_range_have_no_index),
        cmocka_unit_test(many_spans_are_indexed_both_ways),
        cmocka_unit_test(overlapping_steps_agree_with_a_plain_list),
        cmocka_unit_test(formatted_text_parses_back),
        cmocka_unit_test(format_is_the_notation_users_write),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
