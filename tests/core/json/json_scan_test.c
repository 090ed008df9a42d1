// SPDX-License-Identifier: Apache-2.0
#include "core/json/json_scan.h"

#include "core/base/error.h"
#include "core/json/json_read.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_accepted(const char *text)
{
    struct error error = {0};

    if (!json_scan(text, strlen(text), &error)) fail_msg("%s: %s", text, error.message);
}

static void assert_refused(const char *text, const char *expected)
{
    struct error error = {0};

    if (json_scan(text, strlen(text), &error)) fail_msg("accepted: %s", text);
    assert_string_equal(error.message, expected);
}

static void every_kind_of_value_is_accepted(void **state)
{
    assert_accepted("null");
    assert_accepted(" \t\r\n[true, false] \n");
    assert_accepted("{}");
    assert_accepted("[]");
    assert_accepted("{\"a\": {\"b\": [1, \"x\", null]}, \"\": 0}");
    assert_accepted("\"\\\"\\\\\\/\\b\\f\\n\\r\\t\\u00e9\\ud83d\\ude00\"");
    assert_accepted("\"\xc3\xa9\xf0\x9f\x98\x80\"");
}

static void numbers_follow_the_grammar(void **state)
{
    static const char *const good[] = {"0", "-0", "10", "-1.5", "0.25", "1e5", "1E+5", "1e-5", "-0.0e0", "1e-400"};

    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        assert_accepted(good[i]);
    assert_refused("01", "line 1, column 1: a number does not begin with a zero");
    assert_refused("-012", "line 1, column 1: a number does not begin with a zero");
    assert_refused("+1", "line 1, column 1: expected a value, got '+'");
    assert_refused(".5", "line 1, column 1: expected a value, got '.'");
    assert_refused("1.", "line 1, column 3: expected a digit, got the end of the text");
    assert_refused("1.e5", "line 1, column 3: expected a digit, got 'e'");
    assert_refused("[1e]", "line 1, column 4: expected a digit, got ']'");
    assert_refused("-", "line 1, column 2: expected a digit, got the end of the text");
    assert_refused("-Infinity", "line 1, column 2: expected a digit, got 'I'");
    assert_refused("NaN", "line 1, column 1: expected a value, got 'N'");
    assert_refused("0x10", "line 1, column 2: expected the end of the text, got 'x'");
}

static void numbers_that_are_no_double_are_refused(void **state)
{
    char text[65];

    assert_refused("[1e309]", "line 1, column 2: the number 1e309 is too large");
    assert_refused("-1e99999999999", "line 1, column 1: the number -1e99999999999 is too large");
    memset(text, '1', 64);
    text[64] = '\0';
    assert_refused(text, "line 1, column 1: expected a number of at most 63 characters");
    text[63] = '\0';
    assert_accepted(text);
}

static void text_after_the_value_is_refused(void **state)
{
    assert_refused("{} {}", "line 1, column 4: expected the end of the text, got '{'");
    assert_refused("1,", "line 1, column 2: expected the end of the text, got ','");
    assert_false(json_scan("1\0", 2, NULL));
}

static void structure_is_checked(void **state)
{
    assert_refused("", "line 1, column 1: expected a value, got the end of the text");
    assert_refused("[1,]", "line 1, column 4: expected a value, got ']'");
    assert_refused("[1 2]", "line 1, column 4: expected ',' or ']', got '2'");
    assert_refused("[", "line 1, column 2: expected a value, got the end of the text");
    assert_refused("{\"a\":1,}", "line 1, column 8: expected a key in double quotes, got '}'");
    assert_refused("{a:1}", "line 1, column 2: expected a key in double quotes, got 'a'");
    assert_refused("{\"a\" 1}", "line 1, column 6: expected ':' after a key, got '1'");
    assert_refused("{\"a\":1 \"b\":2}", "line 1, column 8: expected ',' or '}', got '\"'");
    assert_refused("{\"a\":1]", "line 1, column 7: expected ',' or '}', got ']'");
    assert_refused("truE", "line 1, column 1: expected a value, got 't'");
    assert_refused("// x", "line 1, column 1: expected a value, got '/'");
    assert_refused("\xef\xbb\xbf{}", "line 1, column 1: expected a value, got byte 0xef");
}

static void place_counts_lines_and_characters(void **state)
{
    assert_refused("{\n  \"a\": 1,\n  \"b\": x\n}", "line 3, column 8: expected a value, got 'x'");
    assert_refused("[\"\xc3\xa9\xe2\x82\xac\", x]", "line 1, column 8: expected a value, got 'x'");
}

static void strings_hold_text_only(void **state)
{
    assert_refused("\"a\nb\"", "line 1, column 3: byte 0x0a in a string: write it as an escape");
    assert_refused("\"\x01\"", "line 1, column 2: byte 0x01 in a string: write it as an escape");
    assert_refused("\"a\xff\"", "line 1, column 3: byte 0xff is not UTF-8");
    assert_refused("\"\xed\xa0\x80\"", "line 1, column 2: byte 0xed is not UTF-8");
    assert_refused("\"\xc3\"", "line 1, column 2: byte 0xc3 is not UTF-8");
    assert_refused("\"\\u0000\"", "line 1, column 2: \\u0000 is not allowed in a string");
    assert_refused("\"\\ud800\"", "line 1, column 2: half of a surrogate pair");
    assert_refused("\"\\ud800\\u0041\"", "line 1, column 2: half of a surrogate pair");
    assert_refused("\"\\udc00\"", "line 1, column 2: half of a surrogate pair");
    assert_refused("\"\\u12g4\"", "line 1, column 2: expected four hexadecimal digits after \\u");
    assert_refused("\"\\u12", "line 1, column 2: expected four hexadecimal digits after \\u");
    assert_refused("\"\\x41\"", "line 1, column 3: expected one of \"\\/bfnrtu after a backslash, got 'x'");
    assert_refused("\"\\", "line 1, column 3: expected the rest of an escape, got the end of the text");
    assert_refused("[\"abc", "line 1, column 2: this string has no closing quote");
    assert_false(json_scan("\"a\0b\"", 5, NULL));
}

static void depth_is_limited(void **state)
{
    char text[2 * JSON_DEPTH_LIMIT + 3];

    memset(text, '[', JSON_DEPTH_LIMIT);
    memset(text + JSON_DEPTH_LIMIT, ']', JSON_DEPTH_LIMIT);
    text[2 * JSON_DEPTH_LIMIT] = '\0';
    assert_accepted(text);
    memset(text, '[', JSON_DEPTH_LIMIT + 1);
    memset(text + JSON_DEPTH_LIMIT + 1, ']', JSON_DEPTH_LIMIT + 1);
    text[2 * JSON_DEPTH_LIMIT + 2] = '\0';
    assert_refused(text, "line 1, column 33: nested deeper than 32 levels");
}

static void a_megabyte_of_brackets_is_refused_at_the_limit(void **state)
{
    size_t size = 1 << 20;
    char *text = malloc(size);

    assert_non_null(text);
    memset(text, '[', size);
    assert_false(json_scan(text, size, NULL));
    free(text);
}

static void count_of_values_is_limited(void **state)
{
    size_t count = JSON_VALUE_LIMIT - 1;
    char *text = malloc(2 * count + 3);

    assert_non_null(text);
    for (size_t i = 0; i < count; i++)
        memcpy(text + 2 * i, i == 0 ? "[1" : ",1", 2);
    text[2 * count] = ']';
    assert_true(json_scan(text, 2 * count + 1, NULL));
    memcpy(text + 2 * count, ",1]", 3);
    assert_false(json_scan(text, 2 * count + 3, NULL));
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_value_is_accepted),
        cmocka_unit_test(numbers_follow_the_grammar),
        cmocka_unit_test(numbers_that_are_no_double_are_refused),
        cmocka_unit_test(text_after_the_value_is_refused),
        cmocka_unit_test(structure_is_checked),
        cmocka_unit_test(place_counts_lines_and_characters),
        cmocka_unit_test(strings_hold_text_only),
        cmocka_unit_test(depth_is_limited),
        cmocka_unit_test(a_megabyte_of_brackets_is_refused_at_the_limit),
        cmocka_unit_test(count_of_values_is_limited),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
