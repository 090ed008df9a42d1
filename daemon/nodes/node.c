// SPDX-License-Identifier: Apache-2.0
#include "daemon/nodes/node.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "daemon/nodes/node_launch.h"
#include "daemon/nodes/node_workers.h"
#include "daemon/schedule/retry.h"
#include "daemon/settings/pool_options.h"
#include "node/node_look.h"
#include "node/node_pipe.h"
#include "node/node_probe.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    HOST_SIZE = 255,          // bytes of a machine's name
    PROBE_MS = 150 * 1000,    // from its launch until its folders are looked at
    ANSWER_MS = 60 * 1000,    // so long a launcher, or a look at the folders, may take
    BEATS = 4,                // beats in the time after which silence is an end
    BEHIND_LIMIT = 16 << 20,  // bytes that a node has not read: it gets no more frames
    WAITING_LIMIT = 64 << 20, // it is ended
    TEXT_SIZE = 512,          // bytes that are logged of a line that is none of a node
    TEXT_LINES = 20,          // such lines a second that are logged
    BANNER_LINES = 1000       // lines that shells may print first
};

struct node {
    uv_loop_t *loop;
    struct node_params params;
    const struct node_handlers *handlers;
    void *user;
    enum node_state state;
    struct retry_backoff backoff;
    struct node_launch *launch; // NULL: none
    struct node_pipe *pipe;     // NULL: none
    struct node_look *look;     // NULL: none
    struct node_probe probe;    // owned
    int64_t launched_ms, next_beat_ms, now_ms;
    int64_t asked_ms; // when it was asked to look at the roots; 0: it has answered
    int banner_lines;
    int text_lines; // in the second from `text_since_ms`
    int64_t text_since_ms;
    struct node_workers workers;
    char *host, *reason;  // owned
    const char *own_name; // as it was created with
    char *name, *place;   // owned; see node_allow; NULL: its own
    struct node_stay stay;
    bool is_held, is_stopping;
    bool is_dismissed; // its end is wanted
};

static bool on_line(void *user, const char *bytes, size_t length, struct error *error);
static void on_end(void *user, const struct error *error);

static const struct node_pipe_handlers pipe_handlers = {.on_line = on_line, .on_end = on_end};

struct node *node_create(uv_loop_t *loop, const struct node_params *params, const struct node_handlers *handlers,
                         void *user)
{
    struct node *node = xcalloc(1, sizeof *node);

    node->loop = loop;
    node->params = *params;
    node->own_name = params->name;
    node->is_held = params->pool->launcher == POOL_SLURM;
    node->handlers = handlers;
    node->user = user;
    node->reason = xstrdup("it is to be started");
    return node;
}

void node_destroy(struct node *node)
{
    if (!node) return;
    free(node->host);
    free(node->reason);
    free(node->name);
    free(node->place);
    free(node);
}

// What a node or its launcher says is one line, without what steers a terminal.
static char *make_plain(char *text)
{
    log_disarm(text);
    for (char *at = text; *at; at++)
        if (*at == '\n' || *at == '\t') *at = ' ';
    return text;
}

static void set_reason(struct node *node, char *reason)
{
    free(node->reason);
    node->reason = reason;
}

static void log_text(struct node *node, const char *text, size_t length)
{
    if (node->now_ms - node->text_since_ms >= 1000) {
        node->text_since_ms = node->now_ms;
        node->text_lines = 0;
    }
    if (++node->text_lines <= TEXT_LINES)
        log_info("node %s: %.*s", node->params.name, (int)(length < TEXT_SIZE ? length : TEXT_SIZE), text);
    if (node->text_lines == TEXT_LINES + 1) log_info("node %s: it says more, which is left out", node->params.name);
}

static void on_text(void *user, const char *line)
{
    log_text(user, line, strlen(line));
}

// The files of a probe that goes no further.
static void remove_probe(struct node *node)
{
    node_look_abandon(node_look_start(node->params.looks, &node->probe, NODE_LOOK_REMOVES, NULL, NULL));
}

// The node and all its workers are gone. A reason from the launcher or the node's own words goes before.
static void lose(struct node *node, const char *reason)
{
    const char *text = node->launch ? node_launch_last_text(node->launch) : "";
    bool was_ready = node->state == NODE_READY;
    char *full = make_plain(xasprintf("node %s: %s%s%s", node->params.name, reason, *text ? ": " : "", text));

    if (!node->is_stopping) log_about(node->is_dismissed ? LOG_INFO : LOG_WARN, &(struct log_subject){0}, "%s", full);
    node->state = NODE_DOWN;
    set_reason(node, full);
    if (node->pipe) node_pipe_close(node->pipe);
    if (node->launch) node_launch_end(node->launch);
    node_look_abandon(node->look);
    if (node->probe.count > 0) remove_probe(node);
    node->pipe = node->workers.pipe = NULL;
    node->launch = NULL;
    node->look = NULL;
    node->asked_ms = 0;
    if (!was_ready && !node->is_stopping) retry_backoff_fail(&node->backoff, node->now_ms);
    node_workers_lose(&node->workers, node->reason);
    node->handlers->on_change(node->user, node);
}

static void launch(struct node *node)
{
    const char *const words[] = {node->place ? "step" : "node", node->place ? node->place : node->params.name, NULL};
    const struct node_launch_order order = {
        .socket = node->params.launch_socket, .pool = node->params.pool, .words = words};
    struct node_launch_fds fds;
    struct error error = {0};

    node->launch = node_launch_start(node->loop, &order, on_text, node, &fds, &error);
    if (node->launch)
        node->pipe = node_pipe_open(node->loop, fds.in, fds.out, WORKER_CHILD_LINE_LIMIT, &pipe_handlers, node, &error);
    if (!node->pipe) {
        lose(node, error.message);
        return;
    }
    node->state = NODE_STARTING;
    node->launched_ms = node->now_ms;
    node->banner_lines = 0;
    set_reason(node, xasprintf("node %s: its launcher runs, it has not answered", node->params.name));
    node->handlers->on_change(node->user, node);
}

static void check_pipe(struct node *node)
{
    const struct pool_options *pool = node->params.pool;
    char reason[80];

    if (node->state == NODE_STARTING && node->now_ms - node->launched_ms > ANSWER_MS) {
        lose(node, "it did not answer within 60 s");
    } else if (node->asked_ms && node->now_ms - node->asked_ms > ANSWER_MS) {
        lose(node, "it did not look at the folders within 60 s");
    } else if (node->state == NODE_PROBING && node->now_ms - node->launched_ms > PROBE_MS) {
        lose(node, "folders of this machine do not answer: whether it sees them is not known");
    } else if (node_pipe_waiting_bytes(node->pipe) > WAITING_LIMIT ||
               node_pipe_stuck_ms(node->pipe) > pool->heartbeat_ms) {
        lose(node, "it does not read what it is told");
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
    else if (!node->is_held && !node->is_stopping && retry_backoff_wait_ms(&node->backoff, now_ms) == 0)
        launch(node);
}

bool node_is_behind(const struct node *node)
{
    return node->pipe && node_pipe_waiting_bytes(node->pipe) > BEHIND_LIMIT;
}

void node_stop(struct node *node)
{
    node->is_stopping = true;
    if (node->state != NODE_DOWN) lose(node, "the daemon stops");
}

static void set_name(struct node *node, char *name, char *place)
{
    free(node->name);
    free(node->place);
    node->name = name;
    node->place = place;
    node->params.name = name ? name : node->own_name;
}

void node_hold(struct node *node, const char *reason, bool is_dismissed)
{
    if (node->is_held && strcmp(node->reason, reason) == 0) return;
    node->is_held = true;
    node->is_dismissed = is_dismissed;
    if (node->state != NODE_DOWN) lose(node, reason);
    node->is_dismissed = false;
    set_name(node, NULL, NULL);
    set_reason(node, xstrdup(reason));
    node->handlers->on_change(node->user, node);
}

void node_allow(struct node *node, const char *name, const char *place)
{
    if (!node->is_held) return;
    node->is_held = false;
    set_name(node, xstrdup(name), xstrdup(place));
    node->backoff = (struct retry_backoff){0};
    set_reason(node, xasprintf("node %s: it is to be started", name));
    node->handlers->on_change(node->user, node);
}

void node_set_stay(struct node *node, const struct node_stay *stay)
{
    node->stay = *stay;
}

const struct node_stay *node_stay(const struct node *node)
{
    return &node->stay;
}

// Ours for new files. umask() would change it for other threads, if only for a moment.
static int find_umask(void)
{
    char *status;
    const char *line;
    int mask = 022;

    if (!file_read_text("/proc/self/status", 65536, &status, NULL, NULL)) return mask;
    line = strstr(status, "\nUmask:");
    if (line) mask = (int)strtol(line + strlen("\nUmask:"), NULL, 8);
    free(status);
    return mask;
}

static void welcome(struct node *node, int64_t seen_ms)
{
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    json_write_integer_member(&writer, "heartbeat_ms", node->params.pool->heartbeat_ms);
    json_write_integer_member(&writer, "workers", node->params.worker_count);
    json_write_integer_member(&writer, "umask", find_umask());
    json_write_end_object(&writer);
    node_pipe_say(node->pipe, NODE_WELCOME, NODE_NO_WORKER, writer.text, writer.length);
    json_writer_finish(&writer);
    node->state = NODE_READY;
    node->workers.pipe = node->pipe;
    node->next_beat_ms = 0;
    node->backoff = (struct retry_backoff){0};
    set_reason(node, NULL);
    log_info("node %s: ready: %s, workers: %d; what one side writes the other sees within %lld ms", node->params.name,
             node->host, node->params.worker_count, (long long)seen_ms + NODE_PROBE_PAUSE_MS);
    node->handlers->on_change(node->user, node);
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
    node->host = make_plain(xstrndup(host_text, HOST_SIZE));
    if (landlock_abi > 0 || !node->params.pool->wants_landlock) return true;
    (void)json_read_string(&lack, &lack_text, NULL);
    error_set(error, "%s: expected landlock, or landlock=optional in pool %s", lack_text, node->params.pool->name);
    return false;
}

static void refuse(struct node *node, const char *reason)
{
    if (node->state == NODE_READY) retry_backoff_fail(&node->backoff, node->now_ms);
    node_pipe_say_text(node->pipe, NODE_REFUSED, NODE_NO_WORKER, reason);
    lose(node, reason);
}

static void on_written(void *user, struct node_probe *probe, const struct error *error)
{
    struct node *node = user;
    struct json_writer writer = {0};

    node->look = NULL;
    node->probe = *probe;
    if (error->message[0]) {
        // A root that is gone is no fault of the node.
        remove_probe(node);
        if (node->state == NODE_PROBING) lose(node, error->message);
        return;
    }
    node->asked_ms = node->now_ms;
    node_probe_write_json(&node->probe, NULL, &writer);
    node_pipe_say(node->pipe, NODE_PROBE, NODE_NO_WORKER, writer.text, writer.length);
    json_writer_finish(&writer);
}

static void begin_probe(struct node *node)
{
    struct node_probe probe = {0};

    root_marker_make_id(probe.token);
    node->handlers->list_roots(node->user, &probe);
    node->look = node_look_start(node->params.looks, &probe, NODE_LOOK_DAEMON_WRITES, on_written, node);
}

void node_look_at_roots(struct node *node)
{
    if (node->state == NODE_READY && !node->look && !node->asked_ms) begin_probe(node);
}

static void greet(struct node *node)
{
    node->state = NODE_PROBING;
    set_reason(node, xasprintf("node %s: whether it sees the folders is looked at", node->params.name));
    begin_probe(node);
    node->handlers->on_change(node->user, node);
}

static void on_looked(void *user, struct node_probe *probe, const struct error *error)
{
    struct node *node = user;
    int64_t seen_ms = probe->seen_ms;
    bool is_own_fault = probe->is_own_fault;

    node->look = NULL;
    node_probe_finish(probe);
    if (error->message[0] && !is_own_fault)
        refuse(node, error->message);
    else if (error->message[0] && node->state == NODE_PROBING)
        lose(node, error->message);
    else if (node->state == NODE_PROBING)
        welcome(node, seen_ms);
}

static bool take_probed(struct node *node, const struct node_line *line, struct error *error)
{
    struct cJSON *root;
    struct json_node object;
    struct error fault = {0};

    if (!node->asked_ms) {
        error_set(error, "it was not asked to look at the roots");
        return false;
    }
    if (!json_parse(&root, line->rest, line->length, error)) return false;
    node->asked_ms = 0;
    object = json_node_root(root);
    if (node_probe_read_json(&node->probe, &object, &fault))
        node->look = node_look_start(node->params.looks, &node->probe, NODE_LOOK_DAEMON_LOOKS, on_looked, node);
    else
        refuse(node, fault.message);
    json_delete(root);
    return true;
}

static bool take_hello(struct node *node, const struct node_line *line, struct error *error)
{
    struct cJSON *root;
    struct json_node hello;
    struct error reason = {0};

    if (!json_parse(&root, line->rest, line->length, error)) return false;
    hello = json_node_root(root);
    if (suits(node, &hello, &reason))
        greet(node);
    else
        refuse(node, reason.message);
    json_delete(root);
    return true;
}

// What shells print before the node's first line is no line of it.
static bool take_first_line(struct node *node, const char *bytes, size_t length, struct error *error)
{
    struct node_line line;

    if (node_line_read(&line, bytes, length, NULL) && line.word == NODE_HELLO) return take_hello(node, &line, error);
    if (length > 0) log_text(node, bytes, length);
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
        return node_workers_take_line(&node->workers, &line, error);
    case NODE_PROBED:
        return take_probed(node, &line, error);
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

void node_start_worker(struct node *node, int number, struct worker_link *link,
                       const struct worker_child_params *params, const struct worker_child_handlers *handlers,
                       void *user)
{
    node_workers_start(&node->workers, number, link, params, handlers, user);
}
