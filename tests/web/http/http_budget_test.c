// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_budget.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static struct http_hold hold_of(struct http_budget *budget, const char *name, bool is_user)
{
    struct http_hold hold = {0};

    http_hold_assign(budget, &hold, name, is_user);
    return hold;
}

static void one_user_holds_a_quarter(void **state)
{
    struct http_budget *budget = http_budget_create(400);
    struct http_hold a = hold_of(budget, "ann", true), b = hold_of(budget, "ann", true);
    struct http_hold c = hold_of(budget, "bob", true);

    (void)state;
    assert_true(http_hold_take(&a, 60));
    assert_false(http_hold_take(&b, 41));
    assert_true(http_hold_take(&b, 40));
    assert_false(http_hold_take(&a, 1));
    assert_true(http_hold_take(&c, 100));
    assert_int_equal(http_budget_bytes(budget), 200);
    http_hold_give(&a, 10);
    assert_true(http_hold_take(&b, 10));
    http_hold_end(&a);
    assert_true(http_hold_take(&b, 50));
    http_hold_end(&b);
    http_hold_end(&c);
    assert_int_equal(http_budget_bytes(budget), 0);
    http_budget_destroy(budget);
}

static void strangers_hold_a_half(void **state)
{
    static const char *const places[] = {"192.0.2.1", "192.0.2.2", "192.0.2.3"};
    struct http_budget *budget = http_budget_create(400);
    struct http_hold strangers[3], ann = hold_of(budget, "ann", true);

    (void)state;
    for (int i = 0; i < 3; i++)
        strangers[i] = hold_of(budget, places[i], false);
    assert_true(http_hold_take(&strangers[0], 100));
    assert_false(http_hold_take(&strangers[0], 1));
    assert_true(http_hold_take(&strangers[1], 100));
    assert_false(http_hold_take(&strangers[2], 1));
    assert_true(http_hold_take(&ann, 100));
    for (int i = 0; i < 3; i++)
        http_hold_end(&strangers[i]);
    http_hold_end(&ann);
    http_budget_destroy(budget);
}

static void all_together_hold_the_limit(void **state)
{
    static const char *const users[] = {"ann", "bob", "carol", "dave", "eve"};
    struct http_budget *budget = http_budget_create(400);
    struct http_hold holds[5];

    (void)state;
    for (int i = 0; i < 5; i++)
        holds[i] = hold_of(budget, users[i], true);
    for (int i = 0; i < 4; i++)
        assert_true(http_hold_take(&holds[i], 100));
    assert_false(http_hold_take(&holds[4], 1));
    assert_false(http_hold_take(&holds[4], SIZE_MAX));
    http_hold_give(&holds[0], 30);
    assert_true(http_hold_take(&holds[4], 30));
    for (int i = 0; i < 5; i++)
        http_hold_end(&holds[i]);
    http_budget_destroy(budget);
}

static void what_a_connection_has_goes_along_with_it(void **state)
{
    struct http_budget *budget = http_budget_create(400);
    struct http_hold a = hold_of(budget, "192.0.2.1", false), b = hold_of(budget, "192.0.2.1", false);
    struct http_hold c = hold_of(budget, "ann", true);

    (void)state;
    assert_true(http_hold_take(&a, 80));
    assert_true(http_hold_take(&c, 50));
    http_hold_assign(budget, &a, "ann", true);
    http_hold_assign(budget, &a, "ann", true);
    assert_int_equal(http_budget_bytes(budget), 130);
    assert_true(http_hold_take(&b, 100)); // the place has all of its own again
    assert_false(http_hold_take(&c, 1));  // and the user is over their limit
    assert_true(http_hold_take(&c, 0));
    http_hold_give(&a, 80);
    assert_true(http_hold_take(&c, 50));
    // A place of a user's name is not the user.
    http_hold_assign(budget, &c, "ann", false);
    assert_true(http_hold_take(&a, 100));
    http_hold_end(&a);
    http_hold_end(&b);
    http_hold_end(&c);
    http_budget_destroy(budget);
}

static void nobody_holds_nothing(void **state)
{
    struct http_hold hold = {0};

    (void)state;
    assert_false(http_hold_take(&hold, 1));
    http_hold_end(&hold);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_user_holds_a_quarter),    cmocka_unit_test(strangers_hold_a_half),
        cmocka_unit_test(all_together_hold_the_limit), cmocka_unit_test(what_a_connection_has_goes_along_with_it),
        cmocka_unit_test(nobody_holds_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
