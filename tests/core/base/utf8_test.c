// SPDX-License-Identifier: Apache-2.0
#include "core/base/utf8.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static size_t length_of(const char *bytes)
{
    return utf8_character_length(bytes, strlen(bytes));
}

static void well_formed_characters_have_their_length(void **state)
{
    assert_int_equal(length_of("a"), 1);
    assert_int_equal(length_of("\xc2\x80"), 2);
    assert_int_equal(length_of("\xe2\x82\xac"), 3);
    assert_int_equal(length_of("\xed\x9f\xbf"), 3);
    assert_int_equal(length_of("\xf0\x90\x80\x80"), 4);
    assert_int_equal(length_of("\xf4\x8f\xbf\xbf"), 4);
}

static void other_bytes_have_none(void **state)
{
    static const char *const wrong[] = {"\x80",
                                        "\xc0\x80",
                                        "\xc1\xbf",
                                        "\xc3",
                                        "\xc3(",
                                        "\xe0\x9f\xbf",
                                        "\xed\xa0\x80",
                                        "\xe2\x82",
                                        "\xe2(\xa1",
                                        "\xf0\x8f\xbf\xbf",
                                        "\xf4\x90\x80\x80",
                                        "\xf5\x80\x80\x80",
                                        "\xf0\x9f\x98",
                                        "\xff",
                                        ""};

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_int_equal(length_of(wrong[i]), 0);
}

static void prefix_cuts_no_character(void **state)
{
    static const char text[] = "ab\xe2\x82\xac!";

    assert_int_equal(utf8_prefix_length(text, 6, 10), 6);
    assert_int_equal(utf8_prefix_length(text, 6, 5), 5);
    assert_int_equal(utf8_prefix_length(text, 6, 4), 2);
    assert_int_equal(utf8_prefix_length(text, 6, 3), 2);
    assert_int_equal(utf8_prefix_length(text, 6, 2), 2);
    assert_int_equal(utf8_prefix_length("\x80\x80", 2, 1), 0);
}

static void hidden_characters_are_found(void **state)
{
    static const struct {
        const char *text;
        uint32_t code; // 0: none is hidden
    } cases[] = {{"", 0},
                 {"a.b c-1 \xc3\xa9 \xe2\x82\xac \xe6\x98\xa0 \xf0\x9f\x8e\xa5", 0},
                 {"a\tb", 0x09},
                 {"a\x7f", 0x7f},
                 {"a\xc2\x85", 0x85},
                 {"a\xc2\xad"
                  "b",
                  0xad},
                 {"gpj\xe2\x80\xaegnp", 0x202e},
                 {"a\xe2\x80\x8b", 0x200b},
                 {"a\xe2\x80\xa8", 0x2028},
                 {"\xe2\x81\xa6"
                  "a",
                  0x2066},
                 {"\xef\xbb\xbf"
                  "a",
                  0xfeff},
                 {"a\xf3\xa0\x81\xa1", 0xe0061}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *found = utf8_find_hidden(cases[i].text);

        assert_int_equal(found ? utf8_code_point(found) : 0, cases[i].code);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(well_formed_characters_have_their_length),
        cmocka_unit_test(other_bytes_have_none),
        cmocka_unit_test(prefix_cuts_no_character),
        cmocka_unit_test(hidden_characters_are_found),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
