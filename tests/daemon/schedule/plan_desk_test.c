// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/plan_desk.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static const struct plan_key cloud = {.owner_uid = 7, .scene = "aa", .segment = "bb"};
static const struct plan_key others[] = {
    {.owner_uid = 8, .scene = "aa", .segment = "bb"},
    {.owner_uid = 7, .scene = "ab", .segment = "bb"},
    {.owner_uid = 7, .scene = "aa", .segment = "ba"},
};
static const struct plan_asker first = {1, 10, 1}, second = {1, 11, 1}, third = {2, 10, 1};

static void one_makes_a_plan_and_others_wait(void **state)
{
    struct plan_desk desk = {0};
    struct plan_asker *askers;
    size_t count;

    assert_false(plan_desk_is_busy(&desk, &cloud));
    assert_true(plan_desk_ask(&desk, &cloud, &first));
    assert_true(plan_desk_is_busy(&desk, &cloud));
    assert_false(plan_desk_ask(&desk, &cloud, &second));
    assert_true(plan_desk_ask(&desk, &cloud, &first)); // again
    assert_false(plan_desk_begin_commit(&desk, &cloud, &second));
    assert_true(plan_desk_begin_commit(&desk, &cloud, &first));
    assert_false(plan_desk_begin_commit(&desk, &cloud, &first));
    assert_false(plan_desk_ask(&desk, &cloud, &third)); // while it is committed
    askers = plan_desk_close(&desk, &cloud, &count);
    assert_int_equal(count, 3);
    assert_true(askers[0].frame == 10 && askers[1].frame == 11 && askers[2].job == 2);
    assert_false(plan_desk_is_busy(&desk, &cloud));
    free(askers);
    plan_desk_finish(&desk);
}

static void each_owner_scene_and_segment_has_its_own_plan(void **state)
{
    struct plan_desk desk = {0};

    assert_true(plan_desk_ask(&desk, &cloud, &first));
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        assert_false(plan_desk_is_busy(&desk, &others[i]));
        assert_true(plan_desk_ask(&desk, &others[i], &second));
        assert_false(plan_desk_is_maker(&desk, &others[i], &first));
    }
    plan_desk_finish(&desk);
}

static void the_next_takes_over_from_a_maker_that_is_gone(void **state)
{
    struct plan_desk desk = {0};
    struct plan_asker next;
    struct plan_key key;

    (void)plan_desk_ask(&desk, &cloud, &first);
    (void)plan_desk_ask(&desk, &cloud, &second);
    (void)plan_desk_ask(&desk, &cloud, &third);
    assert_false(plan_desk_leave(&desk, &second, &key, &next)); // it waited
    assert_true(plan_desk_leave(&desk, &first, &key, &next));
    assert_true(next.job == 2 && next.frame == 10 && key.owner_uid == 7);
    assert_false(plan_desk_is_maker(&desk, &cloud, &first));
    assert_true(plan_desk_is_maker(&desk, &cloud, &third));
    assert_false(plan_desk_leave(&desk, &third, &key, &next));
    assert_false(plan_desk_is_busy(&desk, &cloud));
    // Nobody waits: the next one who asks makes it.
    assert_true(plan_desk_ask(&desk, &cloud, &second));
    plan_desk_finish(&desk);
}

static void a_maker_that_leaves_while_its_plan_is_committed_loses_nothing(void **state)
{
    struct plan_desk desk = {0};
    struct plan_asker next, *askers;
    struct plan_key key;
    size_t count;

    (void)plan_desk_ask(&desk, &cloud, &first);
    (void)plan_desk_ask(&desk, &cloud, &second);
    assert_true(plan_desk_begin_commit(&desk, &cloud, &first));
    assert_false(plan_desk_leave(&desk, &first, &key, &next));
    assert_true(plan_desk_is_busy(&desk, &cloud));
    askers = plan_desk_close(&desk, &cloud, &count);
    assert_int_equal(count, 1);
    assert_int_equal(askers[0].frame, 11);
    free(askers);
    askers = plan_desk_close(&desk, &cloud, &count);
    assert_true(!askers && count == 0);
    plan_desk_finish(&desk);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_makes_a_plan_and_others_wait),
        cmocka_unit_test(each_owner_scene_and_segment_has_its_own_plan),
        cmocka_unit_test(the_next_takes_over_from_a_maker_that_is_gone),
        cmocka_unit_test(a_maker_that_leaves_while_its_plan_is_committed_loses_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
