// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/access.h"

#include "daemon/requests/methods.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const enum access_need needs[] = {NEED_UNSAID, NEED_READ,   NEED_SUBMIT, NEED_ADMIN,
                                         NEED_PEER,   NEED_NOTICE, NEED_NOTHING};

enum { NEED_COUNT = sizeof needs / sizeof *needs };

static void a_peer_is_asked_for_nothing(void **state)
{
    const struct access peer = {0};

    for (int i = 0; i < NEED_COUNT; i++)
        assert_true(access_allows(&peer, needs[i]));
}

static void nobody_may_only_what_needs_nothing(void **state)
{
    const struct access nobody = {.kind = ACCESS_DROPPED, .scope = SCOPE_ADMIN};

    for (int i = 0; i < NEED_COUNT; i++)
        assert_int_equal(access_allows(&nobody, needs[i]), needs[i] == NEED_NOTHING);
}

static void a_scope_includes_those_before_it(void **state)
{
    static const bool allowed[SCOPE_COUNT][NEED_COUNT] = {
        [SCOPE_READ] = {false, true, false, false, false, false, true},
        [SCOPE_SUBMIT] = {false, true, true, false, false, false, true},
        [SCOPE_ADMIN] = {false, true, true, true, false, false, true},
    };

    for (int scope = 0; scope < SCOPE_COUNT; scope++)
        for (int i = 0; i < NEED_COUNT; i++) {
            const struct access access = {.kind = ACCESS_TOKEN, .scope = (enum access_scope)scope};

            assert_int_equal(access_allows(&access, needs[i]), allowed[scope][i]);
        }
}

static void time_ends_a_token_and_no_peer(void **state)
{
    const struct access peer = {0}, token = {.kind = ACCESS_TOKEN, .expires_ms = 1000};

    assert_false(access_has_expired(&peer, INT64_MAX));
    assert_false(access_has_expired(&token, 999));
    assert_true(access_has_expired(&token, 1000));
}

static void every_method_says_what_it_needs(void **state)
{
    struct methods_walk walk = {0};
    const struct method *method;
    int count = 0;

    while ((method = methods_next(&walk))) {
        if (method->need == NEED_UNSAID) fail_msg("%s: expected a need", method->name);
        count++;
    }
    assert_true(count > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_peer_is_asked_for_nothing),      cmocka_unit_test(nobody_may_only_what_needs_nothing),
        cmocka_unit_test(a_scope_includes_those_before_it), cmocka_unit_test(time_ends_a_token_and_no_peer),
        cmocka_unit_test(every_method_says_what_it_needs),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
