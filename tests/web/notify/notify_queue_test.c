// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_queue.h"

#include "core/base/alloc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

static const int64_t HOUR = 3600 * 1000;

static void add(struct notify_queue *queue, const char *target, bool is_webhook, int64_t owner_uid, int64_t id)
{
    struct notify_item item = {
        .id = id, .owner_uid = owner_uid, .made_ms = 1000, .event = xstrdup("done"), .body = xstrdup("{}")};

    notify_queue_add(queue, target, is_webhook, &item);
}

static void a_target_gets_its_items_in_order_one_at_a_time(void **state)
{
    struct notify_queue queue = {.keep_ms = HOUR};
    struct notify_line *line;

    add(&queue, "chat", false, 1, 5);
    add(&queue, "chat", false, 2, 6);
    line = notify_queue_next(&queue, 0);
    assert_int_equal(line->items[0].id, 5);
    notify_queue_begin(line);
    assert_null(notify_queue_next(&queue, 0));
    notify_queue_succeed(line);
    assert_null(notify_queue_next(&queue, 0)); // the daemon does not know yet
    assert_ptr_equal(notify_queue_find_over(&queue), line);
    notify_queue_leave(&queue, line);
    assert_null(notify_queue_find_over(&queue));
    line = notify_queue_next(&queue, 0);
    assert_int_equal(line->items[0].id, 6);
    notify_queue_succeed(line);
    notify_queue_leave(&queue, line);
    assert_int_equal(queue.count, 0);
    assert_int_equal(notify_queue_due_ms(&queue), -1);
    notify_queue_finish(&queue);
}

static void a_target_that_fails_waits_alone(void **state)
{
    struct notify_queue queue = {.keep_ms = HOUR};
    struct notify_line *line;

    add(&queue, "slow", false, 1, 1);
    add(&queue, "quick", false, 1, 2);
    line = notify_queue_next(&queue, 100);
    notify_queue_begin(line);
    notify_queue_fail(&queue, line, 100, 2000, "no");
    assert_int_equal(line->due_ms, 100 + NOTIFY_FIRST_WAIT_MS);
    assert_string_equal(notify_queue_next(&queue, 100)->target, "quick");
    notify_queue_begin(notify_queue_next(&queue, 100));
    assert_null(notify_queue_next(&queue, 100));
    assert_int_equal(notify_queue_due_ms(&queue), 100 + NOTIFY_FIRST_WAIT_MS);
    assert_ptr_equal(notify_queue_next(&queue, 100 + NOTIFY_FIRST_WAIT_MS), line);
    notify_queue_finish(&queue);
}

static void waits_grow_up_to_a_limit(void **state)
{
    assert_int_equal(notify_wait_ms(1), 1000);
    assert_int_equal(notify_wait_ms(2), 2000);
    assert_int_equal(notify_wait_ms(5), 16000);
    assert_int_equal(notify_wait_ms(10), 512000);
    assert_int_equal(notify_wait_ms(11), 600000);
    assert_int_equal(notify_wait_ms(1000000), 600000);
}

static void an_item_is_given_up_after_its_time(void **state)
{
    struct notify_queue queue = {.keep_ms = HOUR};
    struct notify_line *line;

    add(&queue, "chat", false, 1, 1);
    line = notify_queue_next(&queue, 0);
    notify_queue_begin(line);
    notify_queue_fail(&queue, line, 0, 1000 + HOUR - 1, "no");
    assert_null(notify_queue_find_over(&queue));
    notify_queue_begin(line);
    notify_queue_fail(&queue, line, 0, 1000 + HOUR, "still no");
    assert_ptr_equal(notify_queue_find_over(&queue), line);
    assert_string_equal(line->why, "still no");
    notify_queue_finish(&queue);
}

// Addresses that hang hold up neither targets by name nor all addresses of other owners.
static void an_owner_has_few_addresses_at_once(void **state)
{
    struct notify_queue queue = {.keep_ms = HOUR};
    struct notify_line *line;
    char address[32];
    int begun = 0;

    for (int i = 0; i < 10; i++) {
        snprintf(address, sizeof address, "https://a%d/", i);
        add(&queue, address, true, 1, i + 1);
    }
    add(&queue, "https://a0/", true, 2, 20);
    add(&queue, "chat", false, 1, 21);
    while ((line = notify_queue_next(&queue, 0))) {
        notify_queue_begin(line);
        begun++;
    }
    assert_int_equal(begun, NOTIFY_WEBHOOKS_OF_AN_OWNER + 2);
    notify_queue_finish(&queue);
    queue.keep_ms = HOUR;
    for (int i = 0; i < 2 * NOTIFY_WEBHOOKS_AT_ONCE; i++)
        add(&queue, "https://a/", true, i, i + 1);
    for (begun = 0; (line = notify_queue_next(&queue, 0)); begun++)
        notify_queue_begin(line);
    assert_int_equal(begun, NOTIFY_WEBHOOKS_AT_ONCE);
    notify_queue_finish(&queue);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_target_gets_its_items_in_order_one_at_a_time),
        cmocka_unit_test(a_target_that_fails_waits_alone),
        cmocka_unit_test(waits_grow_up_to_a_limit),
        cmocka_unit_test(an_item_is_given_up_after_its_time),
        cmocka_unit_test(an_owner_has_few_addresses_at_once),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
