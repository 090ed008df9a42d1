// SPDX-License-Identifier: Apache-2.0
#include "core/wire/message_stream.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void append(struct message_stream *stream, const char *text)
{
    message_stream_append(stream, text, strlen(text));
}

static void assert_next(struct message_stream *stream, const char *expected)
{
    struct error error = {0};
    size_t length;
    const char *line = message_stream_next(stream, &length, &error);

    assert_string_equal(error.message, "");
    if (!expected) {
        assert_null(line);
        return;
    }
    assert_non_null(line);
    assert_int_equal(length, strlen(expected));
    assert_memory_equal(line, expected, length);
}

static void assert_over_limit(struct message_stream *stream)
{
    struct error error = {0};
    size_t length;

    assert_null(message_stream_next(stream, &length, &error));
    assert_string_equal(error.message, "a line is longer than 8 bytes");
}

static void lines_come_without_their_newline(void **state)
{
    struct message_stream stream = {0};

    assert_next(&stream, NULL);
    append(&stream, "one\ntwo\r\n\n\r\nthr");
    assert_next(&stream, "one");
    assert_next(&stream, "two");
    assert_next(&stream, "");
    assert_next(&stream, "");
    assert_next(&stream, NULL);
    append(&stream, "ee\r");
    assert_next(&stream, NULL);
    append(&stream, "\n");
    assert_next(&stream, "three");
    assert_next(&stream, NULL);
    message_stream_finish(&stream);
}

static void lines_are_the_same_however_they_are_split(void **state)
{
    static const char text[] = "{\"a\":1}\n\nlonger line with words\r\nx\n";
    static const char *const lines[] = {"{\"a\":1}", "", "longer line with words", "x"};

    for (size_t step = 1; step < sizeof text; step++) {
        struct message_stream stream = {0};
        size_t found = 0;

        for (size_t at = 0; at < sizeof text - 1; at += step) {
            size_t rest = sizeof text - 1 - at, room, length;
            char *place = message_stream_reserve(&stream, &room);
            const char *line;

            if (rest > step) rest = step;
            assert_true(room >= rest);
            memcpy(place, text + at, rest);
            message_stream_commit(&stream, rest);
            while ((line = message_stream_next(&stream, &length, NULL))) {
                assert_int_equal(length, strlen(lines[found]));
                assert_memory_equal(line, lines[found], length);
                found++;
            }
        }
        assert_int_equal(found, 4);
        message_stream_finish(&stream);
    }
}

static void line_of_the_limit_is_a_line(void **state)
{
    struct message_stream stream = {.limit_bytes = 8};

    append(&stream, "12345678\n12345678\r\n");
    assert_next(&stream, "12345678");
    assert_next(&stream, "12345678");
    append(&stream, "12345678");
    assert_next(&stream, NULL);
    append(&stream, "\r");
    assert_next(&stream, NULL);
    append(&stream, "\n");
    assert_next(&stream, "12345678");
    message_stream_finish(&stream);
}

static void longer_line_is_an_error_that_stays(void **state)
{
    struct message_stream stream = {.limit_bytes = 8};

    append(&stream, "ok\n123456789");
    assert_next(&stream, "ok");
    assert_over_limit(&stream);
    append(&stream, "\nok\n");
    assert_over_limit(&stream);
    assert_over_limit(&stream);
    message_stream_finish(&stream);
    append(&stream, "123456789\n");
    assert_over_limit(&stream);
    message_stream_finish(&stream);
    append(&stream, "12345678\r1\n");
    assert_over_limit(&stream);
    message_stream_finish(&stream);
}

static void limit_is_that_of_the_protocol_unless_set(void **state)
{
    struct message_stream stream = {0};
    struct error error = {0};
    char *line = malloc(MESSAGE_LINE_LIMIT + 1);
    size_t length;

    assert_non_null(line);
    memset(line, 'x', MESSAGE_LINE_LIMIT + 1);
    message_stream_append(&stream, line, MESSAGE_LINE_LIMIT);
    assert_next(&stream, NULL);
    append(&stream, "\n");
    assert_non_null(message_stream_next(&stream, &length, &error));
    assert_int_equal(length, MESSAGE_LINE_LIMIT);
    message_stream_append(&stream, line, MESSAGE_LINE_LIMIT + 1);
    assert_null(message_stream_next(&stream, &length, &error));
    assert_string_equal(error.message, "a line is longer than 4194304 bytes");
    message_stream_finish(&stream);
    free(line);
}

static void memory_of_a_long_line_is_given_back(void **state)
{
    struct message_stream stream = {0};
    size_t length, room;

    for (int i = 0; i < 1000; i++)
        append(&stream,
               "0123456789012345678901234567890123456789012345678901234567890123456789012345678901234567890123456789");
    append(&stream, "\n");
    assert_non_null(message_stream_next(&stream, &length, NULL));
    assert_int_equal(length, 100000);
    message_stream_reserve(&stream, &room);
    assert_true(stream.capacity <= 64 * 1024);
    message_stream_finish(&stream);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_come_without_their_newline),
        cmocka_unit_test(lines_are_the_same_however_they_are_split),
        cmocka_unit_test(line_of_the_limit_is_a_line),
        cmocka_unit_test(longer_line_is_an_error_that_stays),
        cmocka_unit_test(limit_is_that_of_the_protocol_unless_set),
        cmocka_unit_test(memory_of_a_long_line_is_given_back),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
