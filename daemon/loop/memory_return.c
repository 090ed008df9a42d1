// SPDX-License-Identifier: Apache-2.0
#include "daemon/loop/memory_return.h"

#include "core/base/alloc.h"

#include <malloc.h>
#include <stdbool.h>
#include <stdlib.h>

enum { TRIM_BYTES = 16 * 1024 * 1024, DELAY_MS = 1000, ARENA_LIMIT = 2 };

struct memory_return {
    uv_timer_t timer;
    uv_work_t work;
    size_t freed_bytes; // since the work was begun last
    bool is_working, is_closed;
};

static void on_time(uv_timer_t *timer);
static void on_run(uv_work_t *work);
static void on_done(uv_work_t *work, int status);
static void on_closed(uv_handle_t *handle);

void memory_return_prepare(void)
{
    mallopt(M_ARENA_MAX, ARENA_LIMIT);
}

struct memory_return *memory_return_open(uv_loop_t *loop)
{
    struct memory_return *memory = xcalloc(1, sizeof *memory);

    uv_timer_init(loop, &memory->timer);
    memory->timer.data = memory->work.data = memory;
    return memory;
}

static void free_if_done(struct memory_return *memory)
{
    if (memory->is_closed && !memory->is_working) free(memory);
}

void memory_return_close(struct memory_return *memory)
{
    if (memory) uv_close((uv_handle_t *)&memory->timer, on_closed);
}

static void start_timer(struct memory_return *memory)
{
    if (memory->freed_bytes < TRIM_BYTES || memory->is_working || uv_is_closing((uv_handle_t *)&memory->timer) ||
        uv_is_active((uv_handle_t *)&memory->timer))
        return;
    uv_timer_start(&memory->timer, on_time, DELAY_MS, 0);
}

void memory_return_note(struct memory_return *memory, size_t freed_bytes)
{
    memory->freed_bytes += freed_bytes;
    start_timer(memory);
}

void memory_return_trim(size_t freed_bytes)
{
    if (freed_bytes >= TRIM_BYTES) malloc_trim(0);
}

static void on_time(uv_timer_t *timer)
{
    struct memory_return *memory = timer->data;

    memory->freed_bytes = 0;
    memory->is_working = true;
    uv_queue_work(timer->loop, &memory->work, on_run, on_done);
}

static void on_run(uv_work_t *work)
{
    malloc_trim(0);
}

static void on_done(uv_work_t *work, int status)
{
    struct memory_return *memory = work->data;

    memory->is_working = false;
    if (memory->is_closed)
        free_if_done(memory);
    else
        start_timer(memory);
}

static void on_closed(uv_handle_t *handle)
{
    struct memory_return *memory = handle->data;

    memory->is_closed = true;
    free_if_done(memory);
}
