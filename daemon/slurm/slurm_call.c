// SPDX-License-Identifier: Apache-2.0
#include "daemon/slurm/slurm_call.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/nodes/node_launch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// A controller that is busy answers late; a command of Slurm's gives up after about 10 s, some of them try again.
// How it ended is known soon after its output is closed.
enum { LIMIT_MS = 60 * 1000, TEXT_LIMIT = 4 * 1024 * 1024, END_WAIT_MS = 10, END_WAITS = 500 };

struct slurm_call {
    struct node_launch *launch; // NULL: ended
    uv_pipe_t out;
    uv_timer_t limit; // of its time; then of the wait for its end
    int open_handles, end_waits;
    char *text; // owned
    size_t length, capacity;
    slurm_call_on_end *on_end;
    void *user;
};

static void on_allocate(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct slurm_call *call = handle->data;

    call->text = xgrow(call->text, &call->capacity, call->length + 4096 + 1, 1);
    *buffer = uv_buf_init(call->text + call->length, 4096);
}

static void end(struct slurm_call *call, bool has_ended, const char *reason)
{
    char trouble[NODE_LAUNCH_TEXT_SIZE];
    struct slurm_answer answer = {.trouble = trouble};

    uv_read_stop((uv_stream_t *)&call->out);
    uv_timer_stop(&call->limit);
    snprintf(trouble, sizeof trouble, "%s", reason ? reason : node_launch_last_text(call->launch));
    call->text = xgrow(call->text, &call->capacity, call->length + 1, 1);
    call->text[call->length] = '\0';
    answer.text = has_ended ? call->text : NULL;
    answer.is_whole = has_ended && node_launch_has_succeeded(call->launch);
    call->on_end(call->user, &answer);
}

static void on_end_wait(uv_timer_t *timer)
{
    struct slurm_call *call = timer->data;

    if (node_launch_format_end(call->launch) || ++call->end_waits == END_WAITS) end(call, true, NULL);
}

static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer)
{
    struct slurm_call *call = stream->data;

    if (count > 0) call->length += (size_t)count;
    if (count < 0) {
        uv_read_stop(stream);
        uv_timer_start(&call->limit, on_end_wait, 0, END_WAIT_MS);
    } else if (call->length > TEXT_LIMIT) {
        end(call, false, "it says too much");
    }
}

static void on_limit(uv_timer_t *timer)
{
    end(timer->data, false, "it did not end within 60 s");
}

struct slurm_call *slurm_call_start(uv_loop_t *loop, const struct node_launch_order *order, slurm_call_on_end *on_end,
                                    void *user, struct error *error)
{
    struct node_launch_fds fds;
    struct node_launch *launch = node_launch_start(loop, order, NULL, NULL, &fds, error);
    struct slurm_call *call;

    if (!launch) return NULL;
    close(fds.out);
    call = xcalloc(1, sizeof *call);
    call->launch = launch;
    call->on_end = on_end;
    call->user = user;
    call->open_handles = 2;
    uv_pipe_init(loop, &call->out, 0);
    uv_timer_init(loop, &call->limit);
    call->out.data = call->limit.data = call;
    uv_pipe_open(&call->out, fds.in);
    uv_read_start((uv_stream_t *)&call->out, on_allocate, on_read);
    uv_timer_start(&call->limit, on_limit, LIMIT_MS, 0);
    return call;
}

static void on_closed(uv_handle_t *handle)
{
    struct slurm_call *call = handle->data;

    if (--call->open_handles > 0) return;
    free(call->text);
    free(call);
}

void slurm_call_close(struct slurm_call *call)
{
    if (!call) return;
    node_launch_end(call->launch);
    uv_close((uv_handle_t *)&call->out, on_closed);
    uv_close((uv_handle_t *)&call->limit, on_closed);
}
