// SPDX-License-Identifier: Apache-2.0
#include "node/node_look.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <stdlib.h>

enum { SEEN_MS = 10 * 1000, RUNNING_LIMIT = 2 };

struct node_look {
    uv_work_t work;
    struct node_looks *looks; // borrowed
    struct node_look *next;   // that waits
    struct node_probe probe;  // owned
    enum node_look_step step;
    node_look_on_done *on_done; // NULL: abandoned
    void *user;
    struct error error;
};

static void run(uv_work_t *work)
{
    struct node_look *look = work->data;

    switch (look->step) {
    case NODE_LOOK_DAEMON_WRITES:
        (void)node_probe_write(&look->probe, NODE_PROBE_DAEMON, &look->error);
        break;
    case NODE_LOOK_NODE_ANSWERS:
        if (node_probe_look(&look->probe, NODE_PROBE_DAEMON, SEEN_MS, &look->error))
            (void)node_probe_write(&look->probe, NODE_PROBE_NODE, &look->error);
        break;
    case NODE_LOOK_DAEMON_LOOKS:
        (void)node_probe_look(&look->probe, NODE_PROBE_NODE, SEEN_MS, &look->error);
        node_probe_remove(&look->probe);
        break;
    case NODE_LOOK_REMOVES:
        node_probe_remove(&look->probe);
        break;
    }
}

static void on_done(uv_work_t *work, int status);

static void start_next(struct node_looks *looks)
{
    struct node_look *look = looks->first;

    if (!look || looks->running == RUNNING_LIMIT) return;
    looks->first = look->next;
    looks->running++;
    uv_queue_work(looks->loop, &look->work, run, on_done);
}

static void on_done(uv_work_t *work, int status)
{
    struct node_look *look = work->data;

    look->looks->running--;
    start_next(look->looks);
    if (look->on_done)
        look->on_done(look->user, &look->probe, &look->error);
    else
        node_probe_finish(&look->probe);
    free(look);
}

struct node_look *node_look_start(struct node_looks *looks, struct node_probe *probe, enum node_look_step step,
                                  node_look_on_done *done, void *user)
{
    struct node_look *look = xcalloc(1, sizeof *look), **end = &looks->first;

    look->probe = *probe;
    *probe = (struct node_probe){0};
    look->step = step;
    look->on_done = done;
    look->user = user;
    look->work.data = look;
    look->looks = looks;
    while (*end)
        end = &(*end)->next;
    *end = look;
    start_next(looks);
    return look;
}

void node_look_abandon(struct node_look *look)
{
    if (look) look->on_done = NULL;
}
