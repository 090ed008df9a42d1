// SPDX-License-Identifier: Apache-2.0
#include "core/json/json_write.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_number(double number, const char *expected)
{
    struct json_writer writer = {0};

    json_write_number(&writer, number);
    assert_string_equal(writer.text, expected);
    json_writer_finish(&writer);
}

static void assert_string(const char *text, const char *expected)
{
    struct json_writer writer = {0};

    json_write_string(&writer, text);
    assert_string_equal(writer.text, expected);
    assert_int_equal(writer.length, strlen(expected));
    json_writer_finish(&writer);
}

static void commas_are_where_they_belong(void **state)
{
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    json_write_integer_member(&writer, "a", 1);
    json_write_key(&writer, "b");
    json_write_begin_array(&writer);
    json_write_begin_array(&writer);
    json_write_end_array(&writer);
    json_write_begin_object(&writer);
    json_write_end_object(&writer);
    json_write_bool(&writer, false);
    json_write_null(&writer);
    json_write_raw(&writer, "[7]", 3);
    json_write_end_array(&writer);
    json_write_string_member(&writer, "c", "x");
    json_write_bool_member(&writer, "d", true);
    json_write_number_member(&writer, "e", 0.5);
    json_write_end_object(&writer);
    assert_string_equal(writer.text, "{\"a\":1,\"b\":[[],{},false,null,[7]],\"c\":\"x\",\"d\":true,\"e\":0.5}");
    json_writer_finish(&writer);
}

static void cleared_writer_starts_again(void **state)
{
    struct json_writer writer = {0};

    json_writer_clear(&writer);
    json_write_integer(&writer, 1);
    json_writer_clear(&writer);
    assert_string_equal(writer.text, "");
    json_write_integer(&writer, 2);
    assert_string_equal(writer.text, "2");
    json_writer_finish(&writer);
    json_writer_finish(&writer);
}

static void numbers_are_as_short_as_reads_back(void **state)
{
    assert_number(0, "0");
    assert_number(-0.0, "-0");
    assert_number(1, "1");
    assert_number(-25, "-25");
    assert_number(0.1, "0.1");
    assert_number(-2.25, "-2.25");
    assert_number(0.3, "0.3");
    assert_number(0.1 + 0.2, "0.30000000000000004");
    assert_number(123.456001, "123.456001");
    assert_number(999999999.999999, "999999999.999999");
    assert_number(1e-4, "0.0001");
    assert_number(1e-5, "1e-05");
    assert_number(1e15, "1e+15");
    assert_number(1e300, "1e+300");
    assert_number(3.141592653589793, "3.141592653589793");
}

static void numbers_that_are_not_finite_are_null(void **state)
{
    assert_number((double)INFINITY, "null");
    assert_number((double)-INFINITY, "null");
    assert_number((double)NAN, "null");
}

static void any_number_reads_back(void **state)
{
    uint64_t bits = 88172645463325252u;

    for (int i = 0; i < 200000; i++) {
        struct json_writer writer = {0};
        double number;

        // Xorshift (Marsaglia, Journal of Statistical Software 8, 2003); every other number is one of few decimals.
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        memcpy(&number, &bits, sizeof number);
        if (i % 2) number = (double)(int64_t)(bits % 2000000000u - 1000000000u) / (double)(1 + bits % 9973);
        if (i % 4 == 3) number = round(number * 1e6) / 1e6;
        if (!isfinite(number)) continue;
        json_write_number(&writer, number);
        if (strtod(writer.text, NULL) != number) fail_msg("%a became %s", number, writer.text);
        json_writer_finish(&writer);
    }
}

static void integers_are_exact(void **state)
{
    struct json_writer writer = {0};

    json_write_integer(&writer, INT64_MIN);
    json_write_integer(&writer, INT64_MAX);
    json_write_integer(&writer, 0);
    json_write_integer(&writer, -7);
    assert_string_equal(writer.text, "-9223372036854775808,9223372036854775807,0,-7");
    json_writer_finish(&writer);
}

static void strings_are_escaped(void **state)
{
    assert_string("", "\"\"");
    assert_string("plain / text", "\"plain / text\"");
    assert_string("\"\\\n\t\r\b\f", "\"\\\"\\\\\\n\\t\\r\\b\\f\"");
    assert_string("\x01\x1f\x7f", "\"\\u0001\\u001f\x7f\"");
    assert_string("\xc3\xa9\xf0\x9f\x98\x80", "\"\xc3\xa9\xf0\x9f\x98\x80\"");
    assert_string(NULL, "null");
}

static void bytes_that_are_no_utf8_are_replaced(void **state)
{
    assert_string("a\xff"
                  "b",
                  "\"a\xef\xbf\xbd"
                  "b\"");
    assert_string("\xc3", "\"\xef\xbf\xbd\"");
    assert_string("\xe2\x82", "\"\xef\xbf\xbd\xef\xbf\xbd\"");
}

static void keys_are_escaped(void **state)
{
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    json_write_integer_member(&writer, "a\"b", 1);
    json_write_end_object(&writer);
    assert_string_equal(writer.text, "{\"a\\\"b\":1}");
    json_writer_finish(&writer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(commas_are_where_they_belong),
        cmocka_unit_test(cleared_writer_starts_again),
        cmocka_unit_test(numbers_are_as_short_as_reads_back),
        cmocka_unit_test(numbers_that_are_not_finite_are_null),
        cmocka_unit_test(any_number_reads_back),
        cmocka_unit_test(integers_are_exact),
        cmocka_unit_test(strings_are_escaped),
        cmocka_unit_test(bytes_that_are_no_utf8_are_replaced),
        cmocka_unit_test(keys_are_escaped),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
