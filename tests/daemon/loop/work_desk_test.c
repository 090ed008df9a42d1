// SPDX-License-Identifier: Apache-2.0
#include "daemon/loop/work_desk.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { PIECES = 12 };

// What was done, in order, as one letter a piece; capitals were not run.
static char done_order[PIECES + 1];
static size_t done_count;
static char begun_order[PIECES + 1]; // letters of pieces whose threads have begun, in order
static atomic_size_t begun_count;
static uv_sem_t gate; // pieces run one by one as it lets them

struct letter {
    struct work_piece piece;
    char letter;
    bool was_run;
};

static void on_run(struct work_piece *piece)
{
    begun_order[begun_count++] = ((struct letter *)piece)->letter;
    uv_sem_wait(&gate);
    ((struct letter *)piece)->was_run = true;
}

static void on_done(struct work_piece *piece, bool was_run)
{
    const struct letter *letter = (const struct letter *)piece;

    assert_int_equal(was_run, letter->was_run);
    done_order[done_count++] = (char)(was_run ? letter->letter : letter->letter - 'a' + 'A');
}

static struct letter letters[PIECES];

static void put(struct work_desk *desk, size_t index, char letter, int64_t uid)
{
    letters[index] = (struct letter){.piece = {.run = on_run, .done = on_done, .uid = uid}, .letter = letter};
    work_desk_put(desk, &letters[index].piece);
}

// Lets `count` pieces through, which are all that run. Two are begun before one is done, and one is done at a time.
static void let_through(uv_loop_t *loop, size_t count)
{
    for (size_t done = 0; done < count; done++) {
        size_t before = done_count;

        while (begun_count < (done + 2 < count ? done + 2 : count))
            uv_run(loop, UV_RUN_NOWAIT);
        uv_sem_post(&gate);
        while (done_count == before)
            uv_run(loop, UV_RUN_ONCE);
    }
}

static int begin(void **state)
{
    memset(done_order, 0, sizeof done_order);
    memset(begun_order, 0, sizeof begun_order);
    done_count = 0;
    begun_count = 0;
    return uv_sem_init(&gate, 0);
}

static int end(void **state)
{
    uv_sem_destroy(&gate);
    return 0;
}

static void users_take_turns(void **state)
{
    uv_loop_t loop;
    struct work_desk *desk;

    uv_loop_init(&loop);
    desk = work_desk_create(&loop);
    for (size_t i = 0; i < 6; i++)
        put(desk, i, 'a', 1);
    put(desk, 6, 'b', 2);
    put(desk, 7, 'c', 3);
    put(desk, 8, 'b', 2);
    let_through(&loop, 9);
    assert_true(work_desk_is_idle(desk));
    work_desk_destroy(desk);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    assert_memory_equal(begun_order, "aabc", 4); // two of the first user's had begun when the others came
    assert_non_null(memchr(begun_order + 4, 'b', 2));
}

static void what_is_begun_is_ended_first(void **state)
{
    uv_loop_t loop;
    struct work_desk *desk;

    uv_loop_init(&loop);
    desk = work_desk_create(&loop);
    for (size_t i = 0; i < 4; i++)
        put(desk, i, 'a', 1);
    letters[4] = (struct letter){.piece = {.run = on_run, .done = on_done, .uid = 1, .goes_on = true}, .letter = 'b'};
    work_desk_put(desk, &letters[4].piece);
    let_through(&loop, 5);
    work_desk_destroy(desk);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    assert_memory_equal(begun_order, "aab", 3);
}

static void a_desk_that_stops_runs_no_more(void **state)
{
    uv_loop_t loop;
    struct work_desk *desk;

    uv_loop_init(&loop);
    desk = work_desk_create(&loop);
    for (size_t i = 0; i < 4; i++)
        put(desk, i, 'a', 1);
    work_desk_stop(desk);
    assert_string_equal(done_order, "AA");
    put(desk, 4, 'b', 2);
    assert_string_equal(done_order, "AAB");
    let_through(&loop, 2);
    assert_string_equal(done_order, "AABaa");
    assert_true(work_desk_is_idle(desk));
    work_desk_destroy(desk);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(users_take_turns, begin, end),
        cmocka_unit_test_setup_teardown(what_is_begun_is_ended_first, begin, end),
        cmocka_unit_test_setup_teardown(a_desk_that_stops_runs_no_more, begin, end),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
