// SPDX-License-Identifier: Apache-2.0
#include "daemon/nodes/node.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "daemon/nodes/node_launch.h"
#include "daemon/schedule/retry.h"
#include "daemon/settings/pool_options.h"
#include "node/node_pipe.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    HELLO_MS = 60 * 1000, // so long a launcher may take
    BEATS = 4,            // beats in the time after which silence is an end
    BANNER_LINES = 1000   // lines that shells may print first
};

// The self of a worker's link.
struct node_worker {
    struct node_worker *next;
    struct node *node;
    int number, pid; // 0: not started yet
    const struct worker_child_handlers *handlers;
    void *user;
    bool is_deaf; // no more lines are wanted
};

struct node {
    uv_loop_t *loop;
    struct node_params params;
    node_on_change *on_change;
    void *user;
    enum node_state state;
    struct retry_backoff backoff;
    struct node_launch *launch; // NULL: none
    struct node_pipe *pipe;     // NULL: none
    int64_t launched_ms, next_beat_ms, now_ms;
    int banner_lines;
    struct node_worker *first; // owned by the links
    char *host, *reason;       // owned
    bool is_stopping;
};

static bool on_line(void *user, const char *bytes, size_t length, struct error *error);
static void on_end(void *user, const struct error *error);

static const struct node_pipe_handlers pipe_handlers = {.on_line = on_line, .on_end = on_end};

struct node *node_create(uv_loop_t *loop, const struct node_params *params, node_on_change *on_change, void *user)
{
    struct node *node = xcalloc(1, sizeof *node);

    node->loop = loop;
    node->params = *params;
    node->on_change = on_change;
    node->user = user;
    node->reason = xstrdup("it is to be started");
    return node;
}

void node_destroy(struct node *node)
{
    if (!node) return;
    free(node->host);
    free(node->reason);
    free(node);
}

static void set_reason(struct node *node, char *reason)
{
    free(node->reason);
    node->reason = reason;
}

static void on_text(void *user, const char *line)
{
    struct node *node = user;

    log_info("node %s: %s", node->params.name, line);
}

// The node and all its workers are gone. A reason from the launcher or the node's own words goes before.
static void lose(struct node *node, const char *reason)
{
    const char *text = node->launch ? node_launch_last_text(node->launch) : "";
    bool was_ready = node->state == NODE_READY;
    char *full = xasprintf("node %s: %s%s%s", node->params.name, reason, *text ? ": " : "", text);

    if (!node->is_stopping) log_warn("%s", full);
    node->state = NODE_DOWN;
    set_reason(node, full);
    if (node->pipe) node_pipe_close(node->pipe);
    if (node->launch) node_launch_end(node->launch);
    node->pipe = NULL;
    node->launch = NULL;
    if (!was_ready && !node->is_stopping) retry_backoff_fail(&node->backoff, node->now_ms);
    // Each is closed by its owner meanwhile.
    while (node->first) {
        struct node_worker *worker = node->first;

        worker->handlers->on_end(worker->user, -1, 0, node->reason);
    }
    node->on_change(node->user, node);
}

static void launch(struct node *node)
{
    char **command = pool_options_format_command(node->params.pool, node->params.name);
    struct node_launch_fds fds;
    struct error error = {0};

    node->launch = node_launch_start(node->loop, command, on_text, node, &fds, &error);
    if (node->launch) node->pipe = node_pipe_open(node->loop, fds.in, fds.out, &pipe_handlers, node, &error);
    pool_options_free_command(command);
    if (!node->pipe) {
        lose(node, error.message);
        return;
    }
    node->state = NODE_STARTING;
    node->launched_ms = node->now_ms;
    node->banner_lines = 0;
    set_reason(node, xasprintf("node %s: its launcher runs, it has not answered", node->params.name));
    node->on_change(node->user, node);
}

static void check_pipe(struct node *node)
{
    const struct pool_options *pool = node->params.pool;
    char reason[80];

    if (node->state == NODE_STARTING && node->now_ms - node->launched_ms > HELLO_MS) {
        lose(node, "it did not answer within 60 s");
    } else if (node->state == NODE_READY && node_pipe_silent_ms(node->pipe) > pool->heartbeat_ms) {
        snprintf(reason, sizeof reason, "nothing was heard of it for %.3g s", (double)pool->heartbeat_ms / 1000);
        lose(node, reason);
    } else if (node->state == NODE_READY && node->now_ms >= node->next_beat_ms) {
        node->next_beat_ms = node->now_ms + pool->heartbeat_ms / BEATS;
        node_pipe_say(node->pipe, NODE_BEAT, NODE_NO_WORKER, "", 0);
    }
}

void node_check(struct node *node, int64_t now_ms)
{
    node->now_ms = now_ms;
    if (node->state != NODE_DOWN)
        check_pipe(node);
    else if (!node->is_stopping && retry_backoff_wait_ms(&node->backoff, now_ms) == 0)
        launch(node);
}

void node_stop(struct node *node)
{
    node->is_stopping = true;
    if (node->state != NODE_DOWN) lose(node, "the daemon stops");
}

static void welcome(struct node *node)
{
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    json_write_integer_member(&writer, "heartbeat_ms", node->params.pool->heartbeat_ms);
    json_write_integer_member(&writer, "workers", node->params.worker_count);
    json_write_end_object(&writer);
    node_pipe_say(node->pipe, NODE_WELCOME, NODE_NO_WORKER, writer.text, writer.length);
    json_writer_finish(&writer);
    node->state = NODE_READY;
    node->next_beat_ms = 0;
    node->backoff = (struct retry_backoff){0};
    set_reason(node, NULL);
    log_info("node %s: ready: %s, %d workers", node->params.name, node->host, node->params.worker_count);
    node->on_change(node->user, node);
}

// False, with the reason, when the node cannot be used.
static bool suits(struct node *node, const struct json_node *hello, struct error *error)
{
    struct json_node protocol = json_node_child(hello, "protocol"), version = json_node_child(hello, "version");
    struct json_node host = json_node_child(hello, "host"), landlock = json_node_child(hello, "landlock");
    struct json_node lack = json_node_child(hello, "lack");
    const char *version_text, *host_text, *lack_text = "no landlock";
    int64_t protocol_number, landlock_abi;

    if (!json_read_integer(&protocol, 0, INT_MAX, &protocol_number, error) ||
        !json_read_string(&version, &version_text, error))
        return false;
    if (protocol_number != NODE_PROTOCOL || strcmp(version_text, node->params.version) != 0) {
        error_set(error, "it has march-worker %s (protocol %lld), this is marchd %s (protocol %d)", version_text,
                  (long long)protocol_number, node->params.version, NODE_PROTOCOL);
        return false;
    }
    if (!json_read_string(&host, &host_text, error) || !json_read_integer(&landlock, 0, INT_MAX, &landlock_abi, error))
        return false;
    free(node->host);
    node->host = xstrdup(host_text);
    if (landlock_abi > 0 || !node->params.pool->wants_landlock) return true;
    (void)json_read_string(&lack, &lack_text, NULL);
    error_set(error, "%s: expected landlock, or landlock=optional in pool %s", lack_text, node->params.pool->name);
    return false;
}

static void refuse(struct node *node, const char *reason)
{
    retry_backoff_fail(&node->backoff, node->now_ms);
    node_pipe_say_text(node->pipe, NODE_REFUSED, NODE_NO_WORKER, reason);
    lose(node, reason);
}

static bool take_hello(struct node *node, const struct node_line *line, struct error *error)
{
    struct cJSON *root;
    struct json_node hello;
    struct error reason = {0};

    if (!json_parse(&root, line->rest, line->length, error)) return false;
    hello = json_node_root(root);
    if (suits(node, &hello, &reason))
        welcome(node);
    else
        refuse(node, reason.message);
    json_delete(root);
    return true;
}

static struct node_worker *find(const struct node *node, int number)
{
    struct node_worker *worker = node->first;

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

static bool take_worker_line(struct node *node, const struct node_line *line, struct error *error)
{
    struct node_worker *worker = find(node, line->worker);
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

// What shells print before the node's first line is no line of it.
static bool take_first_line(struct node *node, const char *bytes, size_t length, struct error *error)
{
    struct node_line line;

    if (node_line_read(&line, bytes, length, NULL) && line.word == NODE_HELLO) return take_hello(node, &line, error);
    if (length > 0) log_info("node %s: %.*s", node->params.name, (int)(length < 200 ? length : 200), bytes);
    if (++node->banner_lines <= BANNER_LINES) return true;
    error_set(error, "it says much, but not that it is a node");
    return false;
}

static bool on_line(void *user, const char *bytes, size_t length, struct error *error)
{
    struct node *node = user;
    struct node_line line;

    if (node->state == NODE_STARTING) return take_first_line(node, bytes, length, error);
    if (!node_line_read(&line, bytes, length, error)) return false;
    switch (line.word) {
    case NODE_STARTED:
    case NODE_FAILED:
    case NODE_LOG:
    case NODE_ENDED:
    case NODE_FROM:
        return take_worker_line(node, &line, error);
    case NODE_BEAT:
        return true;
    default:
        error_set(error, "unexpected line: %.*s", (int)(length < 60 ? length : 60), bytes);
        return false;
    }
}

static void on_end(void *user, const struct error *error)
{
    struct node *node = user;
    const char *end = node->launch ? node_launch_format_end(node->launch) : NULL;

    lose(node, error->message[0] ? error->message : end ? end : "its stream ended");
}

enum node_state node_state(const struct node *node)
{
    return node->state;
}

const char *node_name(const struct node *node)
{
    return node->params.name;
}

const struct pool_options *node_pool(const struct node *node)
{
    return node->params.pool;
}

const char *node_host(const struct node *node)
{
    return node->host;
}

const char *node_reason(const struct node *node)
{
    return node->reason;
}

static int worker_pid(const void *self)
{
    const struct node_worker *worker = self;

    return worker->pid;
}

static void worker_send(void *self, const char *bytes, size_t count)
{
    struct node_worker *worker = self;

    if (worker->node->pipe) node_pipe_say_lines(worker->node->pipe, NODE_TO, worker->number, bytes, count);
}

static void worker_kill(void *self)
{
    struct node_worker *worker = self;

    if (worker->node->pipe) node_pipe_say(worker->node->pipe, NODE_KILL, worker->number, "", 0);
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
    struct node_worker *worker = self, **link = &worker->node->first;

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

void node_start_worker(struct node *node, int number, struct worker_link *link,
                       const struct worker_child_params *params, const struct worker_child_handlers *handlers,
                       void *user)
{
    struct node_worker *worker = xcalloc(1, sizeof *worker);
    struct json_writer writer = {0};

    *worker =
        (struct node_worker){.next = node->first, .node = node, .number = number, .handlers = handlers, .user = user};
    node->first = worker;
    *link = (struct worker_link){.calls = &worker_calls, .self = worker};
    json_write_begin_object(&writer);
    json_write_string_member(&writer, "backend", params->backend);
    json_write_integer_member(&writer, "threads", params->thread_count);
    json_write_integer_member(&writer, "memory", params->memory_bytes);
    json_write_bool_member(&writer, "sandbox", params->has_sandbox);
    json_write_bool_member(&writer, "fenced", params->is_fenced);
    json_write_end_object(&writer);
    node_pipe_say(node->pipe, NODE_START, number, writer.text, writer.length);
    json_writer_finish(&writer);
}
