// SPDX-License-Identifier: Apache-2.0
#include "worker/host/host.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/wire/message_stream.h"
#include "node/memory_share.h"
#include "node/node_look.h"
#include "node/node_pipe.h"
#include "node/worker_child.h"
#include "worker/host/host_hello.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <uv.h>

enum {
    TICK_MS = 250,
    WELCOME_MS = 60 * 1000,      // so long the daemon may take to answer the first line
    LOG_WAITING_LIMIT = 1 << 20, // bytes
    BEATS = 4                    // beats in the time after which silence is an end
};

struct hosted {
    struct hosted *next;
    struct host *host;
    int id, turn; // turn: of those that run, by which they share the GPUs
    struct worker_child *child;
};

struct host {
    uv_loop_t loop;
    uv_timer_t tick;
    uv_signal_t terminate;
    struct node_pipe *pipe; // NULL: closed
    struct node_looks looks;
    struct node_look *look; // NULL: none runs
    struct hosted *first;   // owned
    const char *version, *worker;
    bool is_welcome;
    int worker_count;      // workers that the daemon starts here
    int64_t heartbeat_ms;  // silence of so long is an end
    uint64_t next_beat_ms; // monotonic
    int exit_code;
};

static bool on_worker_line(void *user, const char *line, size_t length)
{
    struct hosted *hosted = user;

    // What was written before the line is told before it.
    worker_child_read_log(hosted->child);
    node_pipe_say(hosted->host->pipe, NODE_FROM, hosted->id, line, length);
    return true;
}

static void on_worker_overlong(void *user, const struct error *error)
{
    struct hosted *hosted = user;

    log_warn("worker %d: %s", hosted->id, error->message);
    worker_child_kill(hosted->child);
}

static void on_worker_log(void *user, const char *bytes, size_t count)
{
    struct hosted *hosted = user;
    char text[WORKER_CHILD_LOG_BYTES + 1];

    // Endless output through a slow stream is left out.
    if (node_pipe_waiting_bytes(hosted->host->pipe) > LOG_WAITING_LIMIT) return;
    memcpy(text, bytes, count);
    text[count] = '\0';
    node_pipe_say_text(hosted->host->pipe, NODE_LOG, hosted->id, text);
}

static void forget(struct hosted *hosted)
{
    struct hosted **link = &hosted->host->first;

    while (*link != hosted)
        link = &(*link)->next;
    *link = hosted->next;
    worker_child_close(hosted->child);
    free(hosted);
}

static void on_worker_end(void *user, int64_t status, int signal, const char *reason)
{
    struct hosted *hosted = user;
    char text[40];
    int length = snprintf(text, sizeof text, "%lld %d", (long long)status, signal);

    node_pipe_say(hosted->host->pipe, NODE_ENDED, hosted->id, text, (size_t)length);
    forget(hosted);
}

static const struct worker_child_handlers worker_handlers = {
    .on_line = on_worker_line, .on_overlong = on_worker_overlong, .on_log = on_worker_log, .on_end = on_worker_end};

// The end: workers go at once, for nobody hears them any more.
static void leave(struct host *host, int exit_code)
{
    if (!host->pipe) return;
    host->exit_code = exit_code;
    for (struct hosted *hosted = host->first, *next; hosted; hosted = next) {
        next = hosted->next;
        worker_child_kill(hosted->child);
        worker_child_close(hosted->child);
        free(hosted);
    }
    host->first = NULL;
    // A folder that does not answer would hold the end.
    if (host->look) _exit(exit_code);
    node_pipe_close(host->pipe);
    host->pipe = NULL;
    uv_close((uv_handle_t *)&host->tick, NULL);
    uv_close((uv_handle_t *)&host->terminate, NULL);
}

static struct hosted *find(const struct host *host, int id)
{
    struct hosted *hosted = host->first;

    while (hosted && hosted->id != id)
        hosted = hosted->next;
    return hosted;
}

static bool read_welcome(struct host *host, const struct json_node *welcome, struct error *error)
{
    struct json_node heartbeat = json_node_child(welcome, "heartbeat_ms");
    struct json_node workers = json_node_child(welcome, "workers"), given_mask = json_node_child(welcome, "umask");
    int64_t heartbeat_ms, worker_count, mask;

    if (!json_read_integer(&heartbeat, 1000, INT_MAX, &heartbeat_ms, error) ||
        !json_read_integer(&workers, 1, INT_MAX, &worker_count, error) ||
        !json_read_integer(&given_mask, 0, 0777, &mask, error))
        return false;
    // Pictures get the rights that they have on the farm itself, whatever the launcher left.
    umask((mode_t)mask);
    host->heartbeat_ms = heartbeat_ms;
    host->worker_count = (int)worker_count;
    host->is_welcome = true;
    return true;
}

static void on_looked(void *user, struct node_probe *probe, const struct error *error)
{
    struct host *host = user;
    struct json_writer writer = {0};

    host->look = NULL;
    node_probe_write_json(probe, error->message[0] ? error->message : NULL, &writer);
    node_pipe_say(host->pipe, NODE_PROBED, NODE_NO_WORKER, writer.text, writer.length);
    json_writer_finish(&writer);
    node_probe_finish(probe);
}

static bool read_probe(struct host *host, const struct json_node *object, struct error *error)
{
    struct node_probe probe = {0};
    bool ok = !host->look && node_probe_read_json(&probe, object, error);

    if (ok)
        host->look = node_look_start(&host->looks, &probe, NODE_LOOK_NODE_ANSWERS, on_looked, host);
    else if (host->look)
        error_set(error, "a probe has begun already");
    node_probe_finish(&probe);
    return ok;
}

static bool read_child(const struct host *host, const struct json_node *order, struct worker_child_params *params,
                       struct error *error)
{
    struct json_node backend = json_node_child(order, "backend"), threads = json_node_child(order, "threads");
    struct json_node memory = json_node_child(order, "memory"), sandbox = json_node_child(order, "sandbox");
    struct json_node fenced = json_node_child(order, "fenced");
    int64_t thread_count;

    // The program that runs here, even if another file has its name by now.
    *params = (struct worker_child_params){.program = host->worker ? host->worker : "/proc/self/exe"};
    if (!json_read_string(&backend, &params->backend, error) ||
        !json_read_integer(&threads, 1, INT_MAX, &thread_count, error) ||
        !json_read_integer(&memory, NODE_MEMORY_SHARE, INT64_C(1) << 53, &params->memory_bytes, error) ||
        !json_read_bool(&sandbox, &params->has_sandbox, error) || !json_read_bool(&fenced, &params->is_fenced, error))
        return false;
    params->thread_count = (int)thread_count;
    if (params->memory_bytes == NODE_MEMORY_SHARE) params->memory_bytes = memory_share_find() / host->worker_count;
    return true;
}

// The least that no running worker has.
static int free_turn(const struct host *host)
{
    const struct hosted *hosted = host->first;
    int turn = 0;

    while (hosted) {
        bool is_taken = hosted->turn == turn;

        turn += is_taken;
        hosted = is_taken ? host->first : hosted->next;
    }
    return turn;
}

static bool start(struct host *host, int id, const struct json_node *order, struct error *error)
{
    struct worker_child_params params;
    struct hosted *hosted;
    struct error reason = {0};
    char pid[16], device[16];

    if (find(host, id)) {
        error_set(error, "worker %d runs already", id);
        return false;
    }
    if (!read_child(host, order, &params, error)) return false;
    hosted = xcalloc(1, sizeof *hosted);
    hosted->host = host;
    hosted->id = id;
    hosted->turn = free_turn(host);
    snprintf(device, sizeof device, "turn:%d", hosted->turn % 10000);
    params.device = device;
    hosted->child = worker_child_start(&host->loop, &params, &worker_handlers, hosted, &reason);
    if (!hosted->child) {
        free(hosted);
        node_pipe_say_text(host->pipe, NODE_FAILED, id, reason.message);
        return true;
    }
    hosted->next = host->first;
    host->first = hosted;
    snprintf(pid, sizeof pid, "%d", worker_child_pid(hosted->child));
    node_pipe_say(host->pipe, NODE_STARTED, id, pid, strlen(pid));
    return true;
}

static bool take_object(struct host *host, const struct node_line *line, struct error *error)
{
    struct cJSON *root;
    struct json_node object;
    bool ok;

    if (!json_parse(&root, line->rest, line->length, error)) return false;
    object = json_node_root(root);
    if (line->word == NODE_PROBE)
        ok = read_probe(host, &object, error);
    else
        ok =
            line->word == NODE_WELCOME ? read_welcome(host, &object, error) : start(host, line->worker, &object, error);
    json_delete(root);
    return ok;
}

static void pass_on(const struct host *host, const struct node_line *line)
{
    struct hosted *hosted = find(host, line->worker);

    if (!hosted) return; // it has ended: the daemon will hear of it
    worker_child_send(hosted->child, line->rest, line->length);
    worker_child_send(hosted->child, "\n", 1);
}

static void kill_worker(const struct host *host, int id)
{
    struct hosted *hosted = find(host, id);

    if (hosted) worker_child_kill(hosted->child);
}

static bool on_line(void *user, const char *bytes, size_t length, struct error *error)
{
    struct host *host = user;
    struct node_line line;

    if (!node_line_read(&line, bytes, length, error)) return false;
    switch (line.word) {
    case NODE_PROBE:
    case NODE_WELCOME:
    case NODE_START:
        return take_object(host, &line, error);
    case NODE_TO:
        pass_on(host, &line);
        return true;
    case NODE_KILL:
        kill_worker(host, line.worker);
        return true;
    case NODE_BEAT:
        return true;
    case NODE_REFUSED:
        error_set(error, "marchd refuses this node: %.*s", (int)line.length, line.rest);
        return false;
    default:
        error_set(error, "unexpected line of marchd: %.*s", (int)(length < 60 ? length : 60), bytes);
        return false;
    }
}

static void on_end(void *user, const struct error *error)
{
    if (error->message[0]) log_error("%s", error->message);
    leave(user, error->message[0] ? 1 : 0);
}

static const struct node_pipe_handlers pipe_handlers = {.on_line = on_line, .on_end = on_end};

static void on_tick(uv_timer_t *tick)
{
    struct host *host = tick->data;
    int64_t limit_ms = host->is_welcome ? host->heartbeat_ms : WELCOME_MS;

    if (node_pipe_silent_ms(host->pipe) > limit_ms) {
        log_error("nothing was heard of marchd for %.3g s: this node ends", (double)limit_ms / 1000);
        leave(host, 1);
        return;
    }
    for (struct hosted *hosted = host->first, *next; hosted; hosted = next) {
        next = hosted->next;
        if (worker_child_check(hosted->child)) worker_child_kill(hosted->child);
    }
    if (!host->is_welcome || uv_now(&host->loop) < host->next_beat_ms) return;
    host->next_beat_ms = uv_now(&host->loop) + (uint64_t)host->heartbeat_ms / BEATS;
    node_pipe_say(host->pipe, NODE_BEAT, NODE_NO_WORKER, "", 0);
}

static void on_terminate(uv_signal_t *handle, int signal_number)
{
    log_info("this node was told to end");
    leave(handle->data, 0);
}

static void say_hello(struct host *host)
{
    struct json_writer writer = {0};

    host_hello_write(host->version, &writer);
    node_pipe_say(host->pipe, NODE_HELLO, NODE_NO_WORKER, writer.text, writer.length);
    json_writer_finish(&writer);
}

// Standard output is the stream's: nothing that a library prints may get into it.
static bool take_streams(int fds[2])
{
    fds[0] = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    fds[1] = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    // A shell may have printed something without an end of line.
    if (fds[0] >= 0 && fds[1] >= 0 && write(fds[1], "\n", 1) == 1 && dup2(STDERR_FILENO, STDOUT_FILENO) >= 0 &&
        !close(STDIN_FILENO) && open("/dev/null", O_RDONLY) == STDIN_FILENO)
        return true;
    log_error("standard streams: %s", strerrordesc_np(errno));
    return false;
}

int host_run(const char *version, const char *worker)
{
    struct host host = {.version = version, .worker = worker};
    struct error error = {0};
    int fds[2];

    signal(SIGPIPE, SIG_IGN);
    if (!take_streams(fds)) return 1;
    uv_loop_init(&host.loop);
    host.looks.loop = &host.loop;
    host.pipe = node_pipe_open(&host.loop, fds[0], fds[1], MESSAGE_LINE_LIMIT, &pipe_handlers, &host, &error);
    if (!host.pipe) {
        log_error("%s: march-worker --node is started by marchd, through a launcher", error.message);
        return 2;
    }
    uv_timer_init(&host.loop, &host.tick);
    uv_signal_init(&host.loop, &host.terminate);
    host.tick.data = host.terminate.data = &host;
    uv_timer_start(&host.tick, on_tick, TICK_MS, TICK_MS);
    uv_signal_start(&host.terminate, on_terminate, SIGTERM);
    say_hello(&host);
    uv_run(&host.loop, UV_RUN_DEFAULT);
    uv_loop_close(&host.loop);
    return host.exit_code;
}
