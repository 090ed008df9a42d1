// SPDX-License-Identifier: Apache-2.0
#include "cli/peer/connection.h"

#include "cli/program/interrupt.h"
#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

struct ends {
    struct connection *connection;
    int peer;
};

static int set_up(void **state)
{
    static struct ends ends;
    int fds[2];

    if (socketpair(AF_UNIX, SOCK_STREAM, 0, fds) != 0) return -1;
    ends = (struct ends){connection_adopt(fds[0], "the peer"), fds[1]};
    *state = &ends;
    return 0;
}

static int tear_down(void **state)
{
    struct ends *ends = *state;

    connection_close(ends->connection);
    if (ends->peer >= 0) close(ends->peer);
    return 0;
}

static void say(const struct ends *ends, const char *text)
{
    assert_int_equal(write(ends->peer, text, strlen(text)), strlen(text));
}

static void assert_call_fails(struct ends *ends, enum exit_status status, const char *expected)
{
    struct message reply;
    struct error error = {0};

    assert_false(connection_call(ends->connection, "job.show", "{\"id\":7}", &reply, &error));
    assert_int_equal(connection_failure(ends->connection), status);
    assert_string_equal(error.message, expected);
}

static void call_sends_a_line_and_returns_its_answer(void **state)
{
    struct ends *ends = *state;
    struct message reply;
    struct json_node id;
    char line[256] = "";
    int64_t number;

    say(ends, "{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{\"id\":7}}\n");
    assert_true(connection_call(ends->connection, "job.show", "{\"id\":7}", &reply, NULL));
    id = json_node_child(&reply.body, "id");
    assert_true(json_read_integer(&id, 0, 100, &number, NULL));
    assert_int_equal(number, 7);
    message_finish(&reply);
    assert_true(read(ends->peer, line, sizeof line - 1) > 0);
    assert_non_null(strstr(line, "\"method\":\"job.show\""));
    assert_non_null(strstr(line, "\"params\":{\"id\":7}"));
    assert_int_equal(line[strlen(line) - 1], '\n');
}

static void notifications_before_the_answer_are_kept_in_order(void **state)
{
    struct ends *ends = *state;
    struct message message;

    say(ends, "{\"jsonrpc\":\"2.0\",\"method\":\"first\",\"params\":{}}\n{\"jsonrpc\":\"2.0\",\"method\":\"second\"}\n"
              "{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{}}\n{\"jsonrpc\":\"2.0\",\"method\":\"third\"}\n");
    assert_true(connection_call(ends->connection, "events.subscribe", NULL, &message, NULL));
    message_finish(&message);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(connection_next(ends->connection, 0, &message, NULL), CONNECTION_MESSAGE);
        assert_string_equal(message.method, ((const char *const[]){"first", "second", "third"})[i]);
        message_finish(&message);
    }
    assert_int_equal(connection_next(ends->connection, 0, &message, NULL), CONNECTION_TIMEOUT);
}

static void errors_become_exit_codes(void **state)
{
    struct ends *ends = *state;

    say(ends, "{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"code\":2,\"message\":\"not yours\"}}\n");
    assert_call_fails(ends, EXIT_STATUS_NOT_ALLOWED, "not yours");
    say(ends, "{\"jsonrpc\":\"2.0\",\"id\":2,\"error\":{\"code\":-32602,\"message\":\"params.id: no\"}}\n");
    assert_call_fails(ends, EXIT_STATUS_USAGE, "params.id: no");
    say(ends, "{\"jsonrpc\":\"2.0\",\"id\":3,\"error\":{\"code\":1,\"message\":\"no job 7\"}}\n");
    assert_call_fails(ends, EXIT_STATUS_FAILED, "no job 7");
    say(ends, "{\"jsonrpc\":\"2.0\",\"id\":null,\"error\":{\"code\":-32700,\"message\":\"too long\"}}\n");
    assert_call_fails(ends, EXIT_STATUS_USAGE, "too long");
}

static void closed_connection_means_no_daemon(void **state)
{
    struct ends *ends = *state;

    shutdown(ends->peer, SHUT_WR);
    assert_call_fails(ends, EXIT_STATUS_NO_DAEMON, "the peer closed the connection");
}

static void nonsense_is_named(void **state)
{
    struct ends *ends = *state;
    struct error error = {0};
    struct message message;

    say(ends, "hello\n");
    assert_int_equal(connection_next(ends->connection, -1, &message, &error), CONNECTION_CLOSED);
    assert_non_null(strstr(error.message, "the peer sent what is no message: "));
}

static void interrupt_ends_waiting(void **state)
{
    struct ends *ends = *state;
    struct interrupt interrupt;
    struct message message;

    interrupt_init(&interrupt);
    connection_set_interrupt(ends->connection, &interrupt);
    raise(SIGINT);
    assert_int_equal(connection_next(ends->connection, -1, &message, NULL), CONNECTION_INTERRUPTED);
    interrupt_finish(&interrupt);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(call_sends_a_line_and_returns_its_answer, set_up, tear_down),
        cmocka_unit_test_setup_teardown(notifications_before_the_answer_are_kept_in_order, set_up, tear_down),
        cmocka_unit_test_setup_teardown(errors_become_exit_codes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(closed_connection_means_no_daemon, set_up, tear_down),
        cmocka_unit_test_setup_teardown(nonsense_is_named, set_up, tear_down),
        cmocka_unit_test_setup_teardown(interrupt_ends_waiting, set_up, tear_down),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
