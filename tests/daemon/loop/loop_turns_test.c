// SPDX-License-Identifier: Apache-2.0
#include "daemon/loop/loop_turns.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

enum { NS_PER_MS = 1000 * 1000 };

struct counted_task {
    struct loop_task task;
    int steps_left;
    int busy_ms; // of processor time, each step
    char letter;
};

static char order[64];
static size_t order_length;

static int64_t thread_time_ns(void)
{
    struct timespec now;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static bool on_step(struct loop_task *task)
{
    struct counted_task *counted = (struct counted_task *)task;
    int64_t end_ns = thread_time_ns() + (int64_t)counted->busy_ms * NS_PER_MS;

    while (thread_time_ns() < end_ns)
        ;
    order[order_length++] = counted->letter;
    return --counted->steps_left > 0;
}

static int begin(void **state)
{
    memset(order, 0, sizeof order);
    order_length = 0;
    return 0;
}

static void close_all(uv_loop_t *loop, struct loop_turns *turns)
{
    loop_turns_close(turns);
    uv_run(loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(loop), 0);
}

static void tasks_take_turns_step_by_step(void **state)
{
    struct counted_task a = {.task.step = on_step, .steps_left = 3, .letter = 'a'};
    struct counted_task b = {.task.step = on_step, .steps_left = 2, .letter = 'b'};
    struct counted_task c = {.task.step = on_step, .steps_left = 2, .letter = 'c'};
    struct loop_turns *turns;
    uv_loop_t loop;

    uv_loop_init(&loop);
    turns = loop_turns_open(&loop);
    loop_turns_put(turns, &a.task);
    loop_turns_put(turns, &a.task); // it waits already
    loop_turns_put(turns, &b.task);
    loop_turns_put(turns, &c.task);
    loop_turns_remove(turns, &c.task);
    loop_turns_remove(turns, &c.task);
    while (order_length < 5)
        uv_run(&loop, UV_RUN_NOWAIT);
    assert_string_equal(order, "ababa");
    loop_turns_put(turns, &c.task);
    close_all(&loop, turns);
    assert_string_equal(order, "ababacc");
}

static void a_turn_has_a_few_milliseconds_of_steps(void **state)
{
    struct counted_task slow = {.task.step = on_step, .steps_left = 20, .letter = 's', .busy_ms = 2};
    struct loop_turns *turns;
    uint64_t long_turns = 0;
    uv_loop_t loop;

    uv_loop_init(&loop);
    turns = loop_turns_open(&loop);
    loop_turns_put(turns, &slow.task);
    uv_run(&loop, UV_RUN_NOWAIT);
    assert_in_range(order_length, 1, 3); // processor time, not wall time: other programs do not count
    while (order_length < 20)
        uv_run(&loop, UV_RUN_NOWAIT);
    for (int class = 2; class < TURN_CLASS_COUNT; class ++)
        long_turns += loop_turns_counts(turns)->counts[class];
    assert_true(long_turns >= 6);
    assert_true(loop_turns_counts(turns)->sum_ns >= 30 * NS_PER_MS);
    assert_true(loop_turns_counts(turns)->longest_ns < 20 * (int64_t)NS_PER_MS);
    close_all(&loop, turns);
}

static void turns_are_counted_by_length(void **state)
{
    static const int64_t turns_us[] = {1, 1000, 1001, 4999, 5001, 50000, 50001, 1000000, 1000001};
    static const uint64_t expected[TURN_CLASS_COUNT] = {2, 1, 1, 1, 0, 1, 1, 0, 1, 1};
    struct turn_counts counts = {0};

    for (size_t i = 0; i < sizeof turns_us / sizeof turns_us[0]; i++)
        turn_counts_add(&counts, turns_us[i] * 1000);
    assert_memory_equal(counts.counts, expected, sizeof expected);
    assert_int_equal(counts.longest_ns, 1000001000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(tasks_take_turns_step_by_step, begin),
        cmocka_unit_test_setup(a_turn_has_a_few_milliseconds_of_steps, begin),
        cmocka_unit_test(turns_are_counted_by_length),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
