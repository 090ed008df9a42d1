// SPDX-License-Identifier: Apache-2.0
#include "daemon/nodes/worker_link.h"

static int child_pid(const void *self)
{
    return worker_child_pid(self);
}

static void child_send(void *self, const char *bytes, size_t count)
{
    worker_child_send(self, bytes, count);
}

static void child_kill(void *self)
{
    worker_child_kill(self);
}

static const char *child_check(void *self)
{
    return worker_child_check(self);
}

static void child_read_log(void *self)
{
    worker_child_read_log(self);
}

static void child_close(void *self)
{
    worker_child_close(self);
}

static const struct worker_link_calls child_calls = {.pid = child_pid,
                                                     .send = child_send,
                                                     .kill = child_kill,
                                                     .check = child_check,
                                                     .read_log = child_read_log,
                                                     .close = child_close};

bool worker_link_start_here(struct worker_link *link, uv_loop_t *loop, const struct worker_child_params *params,
                            const struct worker_child_handlers *handlers, void *user, struct error *error)
{
    struct worker_child *child = worker_child_start(loop, params, handlers, user, error);

    *link = (struct worker_link){.calls = &child_calls, .self = child};
    return child != NULL;
}
