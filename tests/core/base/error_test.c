// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static void prefix_goes_before_the_message(void **state)
{
    struct error error = {0};

    error_set(&error, "expected %d", 5);
    error_prefix(&error, "%s[%d]", "phase", 0);
    error_prefix(&error, "scene");
    assert_string_equal(error.message, "scene: phase[0]: expected 5");
}

static void errno_is_appended_in_words(void **state)
{
    struct error error = {0};

    error_set_errno(&error, ENOENT, "cannot open %s", "x");
    assert_string_equal(error.message, "cannot open x: No such file or directory");
}

static void shortages_blame_the_program_or_the_machine(void **state)
{
    struct error error = {0};

    error_set_errno(&error, EMFILE, "cannot open %s", "x");
    assert_non_null(strstr(error.message, "cannot open x: this program may open no more than "));
    assert_true(error_is_shortage(EMFILE));
    error_set_errno(&error, ENFILE, "cannot open %s", "x");
    assert_non_null(strstr(error.message, "cannot open x: all programs together have too many open files"));
    assert_true(error_is_shortage(ENFILE));
    assert_false(error_is_shortage(EACCES));
}

static void long_messages_are_cut_at_the_end(void **state)
{
    struct error error = {0};
    char text[2000];

    memset(text, 'm', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    error_set(&error, "%s", text);
    assert_int_equal(strlen(error.message), sizeof error.message - 1);
    error_prefix(&error, "place");
    assert_int_equal(strlen(error.message), sizeof error.message - 1);
    assert_memory_equal(error.message, "place: mmm", 10);
    error_set_errno(&error, ENOENT, "%s", text);
    assert_int_equal(strlen(error.message), sizeof error.message - 1);
}

static void prefix_too_long_to_fit_is_left_out(void **state)
{
    struct error error = {0};
    char text[sizeof error.message];

    memset(text, 'p', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    error_set(&error, "why");
    error_prefix(&error, "%s", text);
    assert_string_equal(error.message, "why");
    text[sizeof text - 3] = '\0';
    error_prefix(&error, "%s", text);
    assert_memory_equal(error.message, text, sizeof text - 3);
    assert_string_equal(error.message + sizeof text - 3, ": ");
}

static void null_takes_no_message(void **state)
{
    error_set(NULL, "x");
    error_set_errno(NULL, ENOENT, "x");
    error_prefix(NULL, "x");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(prefix_goes_before_the_message),
        cmocka_unit_test(errno_is_appended_in_words),
        cmocka_unit_test(shortages_blame_the_program_or_the_machine),
        cmocka_unit_test(long_messages_are_cut_at_the_end),
        cmocka_unit_test(prefix_too_long_to_fit_is_left_out),
        cmocka_unit_test(null_takes_no_message),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
