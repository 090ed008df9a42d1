// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_queue.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void add(struct picture_queue *queue, struct picture_waiter *waiter, int user, int key)
{
    bool is_new;

    *waiter = (struct picture_waiter){.user = user};
    snprintf(waiter->key, sizeof waiter->key, "%032d", key);
    assert_true(picture_queue_add(queue, waiter, &is_new));
}

static int end(struct picture_queue *queue, struct picture_task *task)
{
    int count = 0;

    for (struct picture_waiter *waiter = picture_queue_end(queue, task); waiter; waiter = waiter->next, count++)
        assert_null(waiter->task);
    return count;
}

static void equal_pictures_are_made_once_for_all_who_wait(void **state)
{
    struct picture_queue queue = {0};
    struct picture_waiter first, second, third;
    struct picture_task *task;

    add(&queue, &first, 1, 7);
    add(&queue, &second, 2, 7);
    task = picture_queue_take(&queue);
    add(&queue, &third, 3, 7); // while it is made
    assert_null(picture_queue_take(&queue));
    assert_int_equal(end(&queue, task), 3);
    assert_int_equal(queue.waiter_count, 0);
    assert_null(queue.tasks);
}

static void users_take_turns(void **state)
{
    struct picture_queue queue = {0};
    struct picture_waiter waiters[6];
    static const int users[] = {1, 1, 1, 1, 2, 3}, expected[] = {0, 4, 5, 1, 2, 3};

    for (int i = 0; i < 6; i++)
        add(&queue, &waiters[i], users[i], i);
    for (int i = 0; i < 6; i++) {
        struct picture_task *task = picture_queue_take(&queue);

        assert_ptr_equal(task->waiters, &waiters[expected[i]]);
        assert_int_equal(end(&queue, task), 1);
    }
}

static void picture_that_nobody_waits_for_is_not_begun(void **state)
{
    struct picture_queue queue = {0};
    struct picture_waiter first, second, other;
    struct picture_task *task;

    add(&queue, &first, 1, 7);
    add(&queue, &second, 1, 7);
    picture_queue_drop(&queue, &first);
    picture_queue_drop(&queue, &second);
    assert_null(picture_queue_take(&queue));
    add(&queue, &first, 1, 7);
    task = picture_queue_take(&queue);
    picture_queue_drop(&queue, &first);
    add(&queue, &other, 1, 8);
    assert_int_equal(end(&queue, task), 0);
    assert_int_equal(end(&queue, picture_queue_take(&queue)), 1);
    assert_int_equal(queue.waiter_count, 0);
}

static void who_waits_is_limited_for_each_and_for_all(void **state)
{
    static struct picture_waiter waiters[PICTURE_WAIT_LIMIT], other;
    struct picture_queue queue = {0};
    struct picture_task *task;
    bool is_new;

    for (int i = 0; i < PICTURE_WAIT_LIMIT; i++)
        add(&queue, &waiters[i], i / PICTURE_USER_WAIT_LIMIT, i);
    other = (struct picture_waiter){.user = 99, .key = "x"};
    assert_false(picture_queue_add(&queue, &other, &is_new));
    picture_queue_drop(&queue, &waiters[0]);
    other.user = 1;
    assert_false(picture_queue_add(&queue, &other, &is_new));
    other.user = 99;
    assert_true(picture_queue_add(&queue, &other, &is_new));
    assert_true(is_new);
    while ((task = picture_queue_take(&queue)))
        assert_int_equal(end(&queue, task), 1);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_pictures_are_made_once_for_all_who_wait),
        cmocka_unit_test(users_take_turns),
        cmocka_unit_test(picture_that_nobody_waits_for_is_not_begun),
        cmocka_unit_test(who_waits_is_limited_for_each_and_for_all),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
