// SPDX-License-Identifier: Apache-2.0
#include "daemon/nodes/node_workers.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "node/node_pipe.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The self of a worker's link.
struct node_worker {
    struct node_worker *next;
    struct node_workers *workers; // of its node
    int number, pid;              // 0: not started yet
    const struct worker_child_handlers *handlers;
    void *user;
    bool is_deaf; // no more lines are wanted
};

static struct node_worker *find(const struct node_workers *workers, int number)
{
    struct node_worker *worker = workers->first;

    while (worker && worker->number != number)
        worker = worker->next;
    return worker;
}

// Reads the JSON string that a line has as its rest; owned by the caller; NULL: it is none.
static char *read_text(const struct node_line *line)
{
    struct cJSON *root;
    struct json_node node;
    const char *text;
    char *copy = NULL;

    if (!json_parse(&root, line->rest, line->length, NULL)) return NULL;
    node = json_node_root(root);
    if (json_read_string(&node, &text, NULL)) copy = xstrdup(text);
    json_delete(root);
    return copy;
}

static void take_log(struct node_worker *worker, const struct node_line *line)
{
    char *text = read_text(line);
    size_t length = text ? strlen(text) : 0, limit = WORKER_CHILD_LOG_BYTES;

    for (size_t start = 0; start < length; start += limit)
        worker->handlers->on_log(worker->user, text + start, length - start < limit ? length - start : limit);
    free(text);
}

static void take_failed(struct node_worker *worker, const struct node_line *line)
{
    char *text = read_text(line);

    worker->handlers->on_end(worker->user, -1, 0, text ? text : "it was not started");
    free(text);
}

static bool take_end(struct node_worker *worker, const struct node_line *line, struct error *error)
{
    char text[48];
    long long status;
    int signal;

    snprintf(text, sizeof text, "%.*s", (int)(line->length < 40 ? line->length : 40), line->rest);
    if (sscanf(text, "%lld %d", &status, &signal) != 2) {
        error_set(error, "expected an exit status and a signal, got \"%s\"", text);
        return false;
    }
    worker->handlers->on_end(worker->user, status, signal, NULL);
    return true;
}

bool node_workers_take_line(struct node_workers *workers, const struct node_line *line, struct error *error)
{
    struct node_worker *worker = find(workers, line->worker);
    char pid[16];

    if (!worker) return true;
    switch (line->word) {
    case NODE_STARTED:
        snprintf(pid, sizeof pid, "%.*s", (int)(line->length < 12 ? line->length : 12), line->rest);
        worker->pid = atoi(pid);
        return true;
    case NODE_FAILED:
        take_failed(worker, line);
        return true;
    case NODE_LOG:
        take_log(worker, line);
        return true;
    case NODE_ENDED:
        return take_end(worker, line, error);
    default:
        worker->is_deaf = worker->is_deaf || !worker->handlers->on_line(worker->user, line->rest, line->length);
        return true;
    }
}

static int worker_pid(const void *self)
{
    const struct node_worker *worker = self;

    return worker->pid;
}

static void worker_send(void *self, const char *bytes, size_t count)
{
    struct node_worker *worker = self;

    if (worker->workers->pipe) node_pipe_say_lines(worker->workers->pipe, NODE_TO, worker->number, bytes, count);
}

static void worker_kill(void *self)
{
    struct node_worker *worker = self;

    if (worker->workers->pipe) node_pipe_say(worker->workers->pipe, NODE_KILL, worker->number, "", 0);
}

// The node looks after its workers, and brings their logs in order.
static const char *worker_check(void *self)
{
    return NULL;
}

static void worker_read_log(void *self)
{
}

static void worker_close(void *self)
{
    struct node_worker *worker = self, **link = &worker->workers->first;

    while (*link != worker)
        link = &(*link)->next;
    *link = worker->next;
    free(worker);
}

static const struct worker_link_calls worker_calls = {.pid = worker_pid,
                                                      .send = worker_send,
                                                      .kill = worker_kill,
                                                      .check = worker_check,
                                                      .read_log = worker_read_log,
                                                      .close = worker_close};

void node_workers_start(struct node_workers *workers, int number, struct worker_link *link,
                        const struct worker_child_params *params, const struct worker_child_handlers *handlers,
                        void *user)
{
    struct node_worker *worker = xcalloc(1, sizeof *worker);
    struct json_writer writer = {0};

    *worker = (struct node_worker){
        .next = workers->first, .workers = workers, .number = number, .handlers = handlers, .user = user};
    workers->first = worker;
    *link = (struct worker_link){.calls = &worker_calls, .self = worker};
    json_write_begin_object(&writer);
    json_write_string_member(&writer, "backend", params->backend);
    json_write_integer_member(&writer, "threads", params->thread_count);
    json_write_integer_member(&writer, "memory", params->memory_bytes);
    json_write_bool_member(&writer, "sandbox", params->has_sandbox);
    json_write_bool_member(&writer, "fenced", params->is_fenced);
    json_write_end_object(&writer);
    node_pipe_say(workers->pipe, NODE_START, number, writer.text, writer.length);
    json_writer_finish(&writer);
}

void node_workers_lose(struct node_workers *workers, const char *reason)
{
    while (workers->first) {
        struct node_worker *worker = workers->first;

        worker->handlers->on_end(worker->user, -1, 0, reason);
    }
}
