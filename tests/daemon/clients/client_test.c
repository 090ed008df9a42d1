// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/client.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"
#include "daemon/clients/client_account.h"
#include "daemon/clients/shared_text.h"
#include "daemon/loop/memory_return.h"
#include "daemon/loop/work_desk.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

enum { CLIENT_COUNT = CLIENT_ACCOUNT_LONG_LINES + 2, SENT_BYTES = 1024 * 1024 };

// Clients of one user, and the other ends of their connections.
struct stage {
    uv_loop_t loop;
    struct client_host host;
    struct client_accounts accounts;
    struct client *clients[CLIENT_COUNT]; // NULL: closed
    int ends[CLIENT_COUNT];
    int messages;
};

static void on_message(void *user, struct client *client, struct message *message)
{
    struct stage *stage = user;

    stage->messages++;
}

static void on_closed(void *user, struct client *client)
{
    struct stage *stage = user;

    for (int i = 0; i < CLIENT_COUNT; i++)
        if (stage->clients[i] == client) stage->clients[i] = NULL;
    if (client->previous) client->previous->next = client->next;
    if (client->next) client->next->previous = client->previous;
    client_accounts_leave(&stage->accounts, client->outgoing.account);
}

static void make_stage(struct stage *stage)
{
    *stage = (struct stage){0};
    uv_loop_init(&stage->loop);
    stage->host = (struct client_host){.loop = &stage->loop,
                                       .turns = loop_turns_open(&stage->loop),
                                       .desk = work_desk_create(&stage->loop),
                                       .memory = memory_return_open(&stage->loop),
                                       .on_message = on_message,
                                       .on_closed = on_closed,
                                       .user = stage};
    for (int i = 0; i < CLIENT_COUNT; i++) {
        int fds[2];
        struct client *client;

        assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fds), 0);
        client = client_create(&stage->host, fds[0]);
        assert_non_null(client);
        client->outgoing.account = client_accounts_join(&stage->accounts, 1000);
        client->previous = i > 0 ? stage->clients[i - 1] : NULL;
        if (i > 0) stage->clients[i - 1]->next = client;
        stage->clients[i] = client;
        stage->ends[i] = fds[1];
        client_start(client);
    }
}

static void finish_stage(struct stage *stage)
{
    for (int i = 0; i < CLIENT_COUNT; i++) {
        if (stage->clients[i]) client_close(stage->clients[i]);
        close(stage->ends[i]);
    }
    memory_return_close(stage->host.memory);
    loop_turns_close(stage->host.turns);
    uv_run(&stage->loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&stage->loop), 0);
    work_desk_destroy(stage->host.desk);
}

static void run_turns(struct stage *stage)
{
    for (int turn = 0; turn < 100; turn++)
        uv_run(&stage->loop, UV_RUN_NOWAIT);
}

// Sends as much as the daemon receives, at most SENT_BYTES; returns how much that was.
static size_t send_line(struct stage *stage, int i)
{
    static const char text[16 * 1024];
    size_t sent = 0;

    for (int idle = 0; idle < 20 && sent < SENT_BYTES;) {
        ssize_t count = send(stage->ends[i], text, sizeof text, MSG_NOSIGNAL);

        assert_true(count > 0 || errno == EAGAIN);
        if (count > 0) sent += (size_t)count;
        idle = count > 0 ? 0 : idle + 1;
        uv_run(&stage->loop, UV_RUN_NOWAIT);
    }
    run_turns(stage);
    return sent;
}

static size_t received(const struct client *client)
{
    return client->stream.end - client->stream.start;
}

static void few_long_lines_of_a_user_are_received_at_a_time(void **state)
{
    struct stage stage;

    make_stage(&stage);
    for (int i = 0; i < CLIENT_COUNT; i++) {
        bool has_place = i < CLIENT_ACCOUNT_LONG_LINES;

        assert_int_equal(send_line(&stage, i) >= SENT_BYTES, has_place);
        assert_int_equal(received(stage.clients[i]) > 3 * CLIENT_SHORT_LINE, has_place);
    }
    // Who ends its line, or leaves, makes room for the next.
    assert_int_equal(send(stage.ends[1], "\n", 1, MSG_NOSIGNAL), 1);
    while (stage.clients[1]->has_place)
        uv_run(&stage.loop, UV_RUN_ONCE);
    client_close(stage.clients[0]);
    run_turns(&stage);
    for (int i = CLIENT_ACCOUNT_LONG_LINES; i < CLIENT_COUNT; i++)
        assert_true(stage.clients[i]->has_place);
    assert_int_equal(stage.messages, 0); // a line of NULs is no message
    finish_stage(&stage);
}

static void who_holds_a_place_and_sends_nothing_is_closed(void **state)
{
    struct stage stage;

    make_stage(&stage);
    send_line(&stage, 0);
    for (int check = 0; check < 20; check++)
        client_check_stuck(stage.clients[0]);
    assert_false(stage.clients[0]->is_closing); // nobody waits for its place
    for (int i = 1; i < CLIENT_COUNT; i++)
        send_line(&stage, i);
    send_line(&stage, 0);
    for (int check = 0; check < 6; check++)
        for (int i = 0; i < CLIENT_COUNT; i++)
            client_check_stuck(stage.clients[i]);
    for (int i = 0; i < CLIENT_COUNT; i++)
        assert_non_null(stage.clients[i]);
    for (int gone = 0; gone < 2; gone++) { // one at a time, as others wait
        for (int i = gone; i < CLIENT_ACCOUNT_LONG_LINES; i++)
            client_check_stuck(stage.clients[i]);
        run_turns(&stage);
        assert_null(stage.clients[gone]);
        assert_non_null(stage.clients[gone + 1]);
        assert_true(stage.clients[CLIENT_ACCOUNT_LONG_LINES + gone]->has_place ||
                    stage.clients[CLIENT_ACCOUNT_LONG_LINES + 1 - gone]->has_place);
    }
    finish_stage(&stage);
}

static struct json_writer make_long_text(size_t size_bytes)
{
    struct json_writer writer = {0};
    char *text = xmalloc(size_bytes);

    memset(text, '7', size_bytes);
    json_write_raw(&writer, text, size_bytes);
    free(text);
    return writer;
}

static void who_reads_no_events_is_closed_at_the_users_limit(void **state)
{
    struct json_writer writer = make_long_text(1024 * 1024);
    struct shared_text *event = shared_text_create(&writer);
    struct stage stage;

    make_stage(&stage);
    for (int i = 0; i < 11; i++)
        client_send_event(stage.clients[2], event);
    for (int i = 0; i < 5; i++)
        client_send_event(stage.clients[1], event);
    run_turns(&stage);
    assert_non_null(stage.clients[2]); // 16 MiB of one user
    client_send_event(stage.clients[1], event);
    run_turns(&stage);
    assert_null(stage.clients[2]); // the slowest
    assert_non_null(stage.clients[1]);
    assert_in_range(event->holders, 2, 3); // what waits for one client holds it once
    shared_text_release(event);
    finish_stage(&stage);
}

static void requests_wait_for_what_their_user_does_not_read(void **state)
{
    static const char request[] = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"x\"}\n";
    struct stage stage;

    make_stage(&stage);
    for (int i = 0; i < 8; i++) {
        struct json_writer value = make_long_text(8 * 1024 * 1024);

        client_send_result(stage.clients[0], "1", &value);
    }
    assert_true(send(stage.ends[0], request, sizeof request - 1, MSG_NOSIGNAL) > 0);
    assert_true(send(stage.ends[1], request, sizeof request - 1, MSG_NOSIGNAL) > 0);
    run_turns(&stage);
    assert_int_equal(stage.messages, 0);
    client_close(stage.clients[0]);
    run_turns(&stage);
    client_check_stuck(stage.clients[1]);
    run_turns(&stage);
    assert_int_equal(stage.messages, 1);
    finish_stage(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_reads_no_events_is_closed_at_the_users_limit),
        cmocka_unit_test(requests_wait_for_what_their_user_does_not_read),
        cmocka_unit_test(few_long_lines_of_a_user_are_received_at_a_time),
        cmocka_unit_test(who_holds_a_place_and_sends_nothing_is_closed),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
