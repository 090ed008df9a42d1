// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_known.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static void a_token_is_known_until_it_is_dropped(void **state)
{
    struct http_known *known = http_known_create();

    (void)state;
    assert_null(http_known_user(known, "a"));
    assert_null(http_known_user(known, NULL));
    http_known_add(known, "a", "ann");
    http_known_add(known, "b", "bob");
    http_known_add(known, "c", "ann");
    assert_string_equal(http_known_user(known, "a"), "ann");
    assert_string_equal(http_known_user(known, "b"), "bob");
    assert_null(http_known_user(known, "d"));
    http_known_drop(known, "a");
    http_known_drop(known, "d");
    assert_null(http_known_user(known, "a"));
    assert_string_equal(http_known_user(known, "b"), "bob");
    assert_string_equal(http_known_user(known, "c"), "ann");
    http_known_add(known, "b", "carol");
    assert_string_equal(http_known_user(known, "b"), "carol");
    http_known_destroy(known);
}

static void the_token_that_nobody_asked_for_is_forgotten(void **state)
{
    struct http_known *known = http_known_create();
    char token[32];

    (void)state;
    http_known_add(known, "old", "ann");
    http_known_add(known, "unused", "bob");
    for (int i = 0; i < 1023; i++) {
        snprintf(token, sizeof token, "t%d", i);
        http_known_add(known, token, "carol");
        assert_string_equal(http_known_user(known, "old"), "ann");
    }
    assert_null(http_known_user(known, "unused"));
    assert_string_equal(http_known_user(known, "t0"), "carol");
    http_known_destroy(known);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_token_is_known_until_it_is_dropped),
        cmocka_unit_test(the_token_that_nobody_asked_for_is_forgotten),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
