// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/notice_list.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void notices_leave_in_any_order(void **state)
{
    struct notice_list list = {0};
    int64_t dropped;

    for (int64_t id = 10; id < 15; id++) {
        notice_list_add(&list, id, 1000, &dropped);
        assert_int_equal(dropped, 0);
    }
    assert_true(notice_list_remove(&list, 12));
    assert_false(notice_list_remove(&list, 12));
    assert_true(notice_list_remove(&list, 14));
    assert_true(notice_list_remove(&list, 10));
    assert_false(notice_list_remove(&list, 99));
    assert_int_equal(list.count, 2);
    assert_int_equal(list.entries[0].id, 11);
    assert_int_equal(list.entries[1].id, 13);
    notice_list_finish(&list);
}

static void an_owner_loses_their_own_oldest(void **state)
{
    struct notice_list list = {0};
    int64_t dropped;

    notice_list_add(&list, 1, 7, &dropped);
    for (int64_t id = 2; id < 2 + NOTICE_LIST_OWNER_LIMIT; id++) {
        notice_list_add(&list, id, 1000, &dropped);
        assert_int_equal(dropped, 0);
    }
    notice_list_add(&list, 5000, 1000, &dropped);
    assert_int_equal(dropped, 2);
    assert_int_equal(list.dropped, 1);
    notice_list_add(&list, 5001, 7, &dropped);
    assert_int_equal(dropped, 0);
    notice_list_finish(&list);
}

static int64_t add_many(struct notice_list *list, int64_t first, int count, int64_t owner_uid)
{
    int64_t dropped;

    for (int i = 0; i < count; i++) {
        notice_list_add(list, first + i, owner_uid, &dropped);
        assert_int_equal(dropped, 0);
    }
    return first + count;
}

static void of_all_owners_the_one_with_most_loses(void **state)
{
    struct notice_list list = {0};
    int64_t dropped, id = 1, first_of_most;

    for (int64_t owner = 0; owner < 18; owner++)
        id = add_many(&list, id, 1000, owner);
    first_of_most = id;
    id = add_many(&list, id, 1900, 99);
    id = add_many(&list, id, 100, 98);
    assert_int_equal(list.count, NOTICE_LIST_LIMIT);
    notice_list_add(&list, id, 98, &dropped);
    assert_int_equal(dropped, first_of_most);
    assert_int_equal(list.count, NOTICE_LIST_LIMIT);
    notice_list_finish(&list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(notices_leave_in_any_order),
        cmocka_unit_test(an_owner_loses_their_own_oldest),
        cmocka_unit_test(of_all_owners_the_one_with_most_loses),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
