// A connection to a daemon that goes away in the middle: a stand-in for it is on the same loop.
// SPDX-License-Identifier: Apache-2.0
#include "web/farm/farm_connection.h"

#include "core/base/alloc.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <uv.h>

#include <cmocka.h>

enum { PATIENCE_MS = 60000 };

struct stage {
    uv_loop_t loop;
    uv_pipe_t listener, daemon;
    uv_timer_t guard;
    int lines; // that the daemon has read
    char room[4096];
    bool is_paused;   // the connection is not read when it breaks
    bool fails_write; // libuv takes no write
    struct farm_connection *connection;
    bool is_ready, is_closed;
    enum farm_end end;
    char why[256];
};

static bool next_write_fails;

int __real_uv_write(uv_write_t *request, uv_stream_t *stream, const uv_buf_t buffers[], unsigned count,
                    uv_write_cb on_written);
int __wrap_uv_write(uv_write_t *request, uv_stream_t *stream, const uv_buf_t buffers[], unsigned count,
                    uv_write_cb on_written);

int __wrap_uv_write(uv_write_t *request, uv_stream_t *stream, const uv_buf_t buffers[], unsigned count,
                    uv_write_cb on_written)
{
    if (!next_write_fails) return __real_uv_write(request, stream, buffers, count, on_written);
    next_write_fails = false;
    return UV_ENOMEM;
}

static void on_room(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct stage *stage = handle->data;

    (void)suggested;
    *buffer = uv_buf_init(stage->room, sizeof stage->room);
}

static void on_read(uv_stream_t *daemon, ssize_t count, const uv_buf_t *buffer)
{
    static char dropped[] = "{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{}}\n";
    static char taken[] = "{\"jsonrpc\":\"2.0\",\"id\":2,\"result\":{\"user\":\"ann\",\"scope\":\"read\"}}\n";
    struct stage *stage = daemon->data;
    uv_buf_t answer;

    for (ssize_t i = 0; i < count; i++) {
        if (buffer->base[i] != '\n' || ++stage->lines > 2) continue;
        answer = stage->lines == 1 ? uv_buf_init(dropped, sizeof dropped - 1) : uv_buf_init(taken, sizeof taken - 1);
        assert_int_equal(uv_try_write(daemon, &answer, 1), answer.len);
    }
}

static void on_client(uv_stream_t *listener, int status)
{
    struct stage *stage = listener->data;

    assert_int_equal(status, 0);
    assert_int_equal(uv_accept(listener, (uv_stream_t *)&stage->daemon), 0);
    uv_read_start((uv_stream_t *)&stage->daemon, on_room, on_read);
}

static void on_daemon_closed(uv_handle_t *daemon)
{
    struct stage *stage = daemon->data;

    farm_connection_send(stage->connection, "{}", 2);
}

static void on_ready(void *user, const struct farm_identity *identity)
{
    struct stage *stage = user;

    assert_string_equal(identity->user, "ann");
    stage->is_ready = true;
    if (stage->is_paused) farm_connection_pause(stage->connection, true);
    if (!stage->fails_write) {
        uv_close((uv_handle_t *)&stage->daemon, on_daemon_closed);
        return;
    }
    next_write_fails = true;
    farm_connection_send(stage->connection, "{}", 2);
    assert_false(stage->is_closed); // never from within
}

static void on_line(void *user, const char *line, size_t length)
{
    (void)user;
    fail_msg("an answer: %.*s", (int)length, line);
}

static void on_drained(void *user)
{
    (void)user;
}

static void on_closed(void *user, enum farm_end end, const char *why)
{
    struct stage *stage = user;

    assert_false(stage->is_closed);
    stage->is_closed = true;
    stage->end = end;
    snprintf(stage->why, sizeof stage->why, "%s", why);
    uv_stop(&stage->loop);
}

static void on_guard(uv_timer_t *guard)
{
    uv_stop(guard->loop);
}

static void close_handle(uv_handle_t *handle, void *user)
{
    (void)user;
    if (!uv_is_closing(handle)) uv_close(handle, NULL);
}

static void run(struct stage *stage, void **state)
{
    static const struct farm_connection_handlers handlers = {on_ready, on_line, on_drained, on_closed};
    char *path = xstrdup(temp_folder_path(state, "socket"));
    struct farm_connection_params params = {
        .loop = &stage->loop, .socket_path = path, .token = "t", .handlers = &handlers, .user = stage};

    uv_loop_init(&stage->loop);
    uv_pipe_init(&stage->loop, &stage->listener, 0);
    uv_pipe_init(&stage->loop, &stage->daemon, 0);
    uv_timer_init(&stage->loop, &stage->guard);
    stage->listener.data = stage->daemon.data = stage;
    assert_int_equal(uv_pipe_bind(&stage->listener, path), 0);
    assert_int_equal(uv_listen((uv_stream_t *)&stage->listener, 1, on_client), 0);
    uv_timer_start(&stage->guard, on_guard, PATIENCE_MS, 0);
    stage->connection = farm_connection_open(&params);
    uv_run(&stage->loop, UV_RUN_DEFAULT);
    if (!stage->is_closed) farm_connection_close(stage->connection);
    close_handle((uv_handle_t *)&stage->listener, NULL);
    close_handle((uv_handle_t *)&stage->daemon, NULL);
    close_handle((uv_handle_t *)&stage->guard, NULL);
    uv_run(&stage->loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&stage->loop), 0);
    free(path);
}

static void a_write_that_libuv_refuses_ends_the_connection(void **state)
{
    struct stage stage = {.fails_write = true};

    run(&stage, state);
    assert_true(stage.is_ready);
    assert_true(stage.is_closed);
    assert_int_equal(stage.end, FARM_AWAY);
    assert_string_equal(stage.why, "not enough memory");
}

static void a_write_that_fails_ends_a_connection_that_is_not_read(void **state)
{
    struct stage stage = {.is_paused = true};

    run(&stage, state);
    assert_true(stage.is_ready);
    assert_true(stage.is_closed);
    assert_int_equal(stage.end, FARM_AWAY);
    assert_string_equal(stage.why, "broken pipe");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_write_that_libuv_refuses_ends_the_connection, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_write_that_fails_ends_a_connection_that_is_not_read, temp_folder_create,
                                        temp_folder_destroy),
    };

    signal(SIGPIPE, SIG_IGN);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
