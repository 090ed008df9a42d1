// SPDX-License-Identifier: Apache-2.0
#include "web/farm/farm_calls.h"

#include "core/base/alloc.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
    IDLE_LIMIT = 32,      // connections that are kept for a next call
    IDLE_TIME_MS = 10000, // so long: each counts among those of its user
    SWEEP_MS = 2000
};

// A connection, and the call that it is for. It is on the list of the idle or belongs to a call.
struct line {
    struct farm_calls *calls; // borrowed
    struct farm_connection *connection;
    char *token;            // owned
    struct farm_call *call; // NULL: idle
    uint64_t idle_since_ms;
    struct line *next; // on the list of the idle
};

struct farm_call {
    struct line *line; // owned
    char *request;     // owned; NULL: nothing is sent, or it was
    size_t length;
    bool wants_line;
    farm_on_answer *on_answer;
    void *user;
};

struct farm_calls {
    uv_loop_t *loop;
    const char *socket_path;
    struct line *idle; // the newest first
    size_t idle_count;
    uv_timer_t sweep;
};

static void on_ready(void *user, const struct farm_identity *identity);
static void on_line(void *user, const char *text, size_t length);
static void on_drained(void *user);
static void on_closed(void *user, enum farm_end end, const char *why);

static const struct farm_connection_handlers handlers = {on_ready, on_line, on_drained, on_closed};

static void free_line(struct line *line)
{
    if (line->token) explicit_bzero(line->token, strlen(line->token));
    free(line->token);
    free(line);
}

static void close_line(struct line *line)
{
    farm_connection_close(line->connection);
    free_line(line);
}

static void forget_idle(struct line *line)
{
    struct line **at = &line->calls->idle;

    while (*at != line)
        at = &(*at)->next;
    *at = line->next;
    line->calls->idle_count--;
}

static void on_sweep(uv_timer_t *timer)
{
    struct farm_calls *calls = timer->data;
    uint64_t now = uv_now(calls->loop);

    for (struct line *line = calls->idle, *next; line; line = next) {
        next = line->next;
        if (now - line->idle_since_ms < IDLE_TIME_MS) continue;
        forget_idle(line);
        close_line(line);
    }
}

struct farm_calls *farm_calls_create(uv_loop_t *loop, const char *socket_path)
{
    struct farm_calls *calls = xcalloc(1, sizeof *calls);

    calls->loop = loop;
    calls->socket_path = socket_path;
    uv_timer_init(loop, &calls->sweep);
    calls->sweep.data = calls;
    uv_timer_start(&calls->sweep, on_sweep, SWEEP_MS, SWEEP_MS);
    return calls;
}

static void on_sweep_closed(uv_handle_t *handle)
{
    free(handle->data);
}

void farm_calls_destroy(struct farm_calls *calls)
{
    for (struct line *line = calls->idle, *next; line; line = next) {
        next = line->next;
        close_line(line);
    }
    uv_close((uv_handle_t *)&calls->sweep, on_sweep_closed);
}

// In a time that does not tell how much of a token was guessed.
static bool is_same(const char *a, const char *b)
{
    size_t length = strlen(a);
    unsigned char difference = 0;

    if (strlen(b) != length) return false;
    for (size_t i = 0; i < length; i++)
        difference |= (unsigned char)(a[i] ^ b[i]);
    return difference == 0;
}

static struct line *find_idle(const struct farm_calls *calls, const char *token)
{
    for (struct line *line = calls->idle; line; line = line->next)
        if (is_same(line->token, token)) return line;
    return NULL;
}

static struct line *open_line(struct farm_calls *calls, const char *token)
{
    struct line *line = xcalloc(1, sizeof *line);
    struct farm_connection_params params = {
        .loop = calls->loop, .socket_path = calls->socket_path, .token = token, .handlers = &handlers, .user = line};

    line->calls = calls;
    line->token = token ? xstrdup(token) : NULL;
    line->connection = farm_connection_open(&params);
    return line;
}

struct farm_call *farm_calls_begin(struct farm_calls *calls, const char *token, const char *request, size_t length,
                                   farm_on_answer *on_answer, void *user)
{
    struct farm_call *call = xcalloc(1, sizeof *call);
    struct line *line = token && request ? find_idle(calls, token) : NULL;

    *call = (struct farm_call){.on_answer = on_answer, .user = user, .wants_line = request != NULL};
    if (line) {
        forget_idle(line);
        farm_connection_send(line->connection, request, length);
    } else {
        line = open_line(calls, token);
        if (request) call->request = memcpy(xmalloc(length), request, length);
        call->length = length;
    }
    call->line = line;
    line->call = call;
    return call;
}

static void free_call(struct farm_call *call)
{
    free(call->request);
    free(call);
}

void farm_call_cancel(struct farm_call *call)
{
    close_line(call->line); // its answer is still to come
    free_call(call);
}

static void answer(struct farm_call *call, const struct farm_answer *answer)
{
    farm_on_answer *on_answer = call->on_answer;
    void *user = call->user;

    free_call(call);
    on_answer(user, answer);
}

static void keep(struct line *line)
{
    struct farm_calls *calls = line->calls;

    line->call = NULL;
    line->idle_since_ms = uv_now(calls->loop);
    line->next = calls->idle;
    calls->idle = line;
    calls->idle_count++;
    if (calls->idle_count <= IDLE_LIMIT) return;
    for (line = calls->idle; line->next;)
        line = line->next;
    forget_idle(line);
    close_line(line);
}

static void on_ready(void *user, const struct farm_identity *identity)
{
    struct line *line = user;
    struct farm_call *call = line->call;

    if (call->wants_line) {
        farm_connection_send(line->connection, call->request, call->length);
        free(call->request);
        call->request = NULL;
        return;
    }
    // A one-time token is used up: nothing is to be found by it.
    answer(call, &(struct farm_answer){.identity = identity});
    close_line(line);
}

static void on_line(void *user, const char *text, size_t length)
{
    struct line *line = user;
    struct farm_call *call = line->call;

    if (!call) { // the daemon says why it closes the connection
        forget_idle(line);
        close_line(line);
        return;
    }
    line->call = NULL;
    answer(call, &(struct farm_answer){
                     .line = text, .length = length, .identity = farm_connection_identity(line->connection)});
    keep(line);
}

static void on_drained(void *user)
{
    (void)user;
}

static void on_closed(void *user, enum farm_end end, const char *why)
{
    struct line *line = user;
    struct farm_call *call = line->call;

    if (call)
        answer(call, &(struct farm_answer){.end = end, .why = why});
    else
        forget_idle(line);
    free_line(line);
}
