// SPDX-License-Identifier: Apache-2.0
#include "daemon/loop/loop_turns.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <time.h>

enum { STEPS_NS = 5 * 1000 * 1000 }; // of one turn

struct loop_turns {
    uv_prepare_t prepare; // its callback ends a turn
    uv_idle_t idle;       // active while tasks wait
    struct loop_task *first, *last;
    struct turn_counts counts;
    int64_t turn_began_ns; // thread time
    int open_handles;
};

static void on_idle(uv_idle_t *idle);
static void on_prepare(uv_prepare_t *prepare);
static void on_closed(uv_handle_t *handle);

static int64_t thread_time_ns(void)
{
    struct timespec now;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

struct loop_turns *loop_turns_open(uv_loop_t *loop)
{
    struct loop_turns *turns = xcalloc(1, sizeof *turns);

    uv_prepare_init(loop, &turns->prepare);
    uv_idle_init(loop, &turns->idle);
    turns->prepare.data = turns->idle.data = turns;
    turns->open_handles = 2;
    turns->turn_began_ns = thread_time_ns();
    uv_prepare_start(&turns->prepare, on_prepare);
    return turns;
}

static void take_step(struct loop_turns *turns)
{
    struct loop_task *task = turns->first;

    turns->first = task->next;
    if (!turns->first) turns->last = NULL;
    task->is_waiting = false;
    if (task->step(task)) loop_turns_put(turns, task);
}

static void on_idle(uv_idle_t *idle)
{
    struct loop_turns *turns = idle->data;
    int64_t end_ns = thread_time_ns() + STEPS_NS;

    while (turns->first && thread_time_ns() < end_ns)
        take_step(turns);
    if (!turns->first) uv_idle_stop(&turns->idle);
}

static void on_prepare(uv_prepare_t *prepare)
{
    struct loop_turns *turns = prepare->data;
    int64_t now_ns = thread_time_ns();

    turn_counts_add(&turns->counts, now_ns - turns->turn_began_ns);
    turns->turn_began_ns = now_ns;
}

void loop_turns_put(struct loop_turns *turns, struct loop_task *task)
{
    if (task->is_waiting) return;
    task->is_waiting = true;
    task->next = NULL;
    *(turns->last ? &turns->last->next : &turns->first) = task;
    turns->last = task;
    if (!uv_is_closing((uv_handle_t *)&turns->idle)) uv_idle_start(&turns->idle, on_idle);
}

void loop_turns_remove(struct loop_turns *turns, struct loop_task *task)
{
    struct loop_task *previous = NULL;

    if (!task->is_waiting) return;
    for (struct loop_task *other = turns->first; other != task; other = other->next)
        previous = other;
    *(previous ? &previous->next : &turns->first) = task->next;
    if (turns->last == task) turns->last = previous;
    task->is_waiting = false;
}

const struct turn_counts *loop_turns_counts(const struct loop_turns *turns)
{
    return &turns->counts;
}

void loop_turns_close(struct loop_turns *turns)
{
    if (!turns) return;
    while (turns->first)
        take_step(turns);
    uv_close((uv_handle_t *)&turns->prepare, on_closed);
    uv_close((uv_handle_t *)&turns->idle, on_closed);
}

static void on_closed(uv_handle_t *handle)
{
    struct loop_turns *turns = handle->data;

    if (--turns->open_handles == 0) free(turns);
}
