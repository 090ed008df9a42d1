// A request to march-launch with its descriptors, as it arrives; and requests of others, which are refused.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/launch/launch_request.h"

#include "core/base/error.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

struct ends {
    int sockets[2], pipes[3][2];
};

static struct ends open_ends(void)
{
    struct ends ends;

    assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.sockets), 0);
    for (int i = 0; i < 3; i++)
        assert_int_equal(pipe2(ends.pipes[i], O_CLOEXEC), 0);
    return ends;
}

static void close_ends(const struct ends *ends)
{
    for (int i = 0; i < 2; i++) {
        close(ends->sockets[i]);
        for (int k = 0; k < 3; k++)
            close(ends->pipes[k][i]);
    }
}

// The next number that the kernel gives: it grows where descriptors are left open.
static int next_fd(void)
{
    int fd = open("/dev/null", O_RDONLY | O_CLOEXEC);

    close(fd);
    return fd;
}

static void a_request_arrives_with_its_pipes(void **state)
{
    struct ends ends = open_ends();
    const int fds[] = {ends.pipes[0][0], ends.pipes[1][1], ends.pipes[2][1]};
    struct launch_request request;
    int before = next_fd();
    char byte = 0;

    assert_true(launch_request_send(ends.sockets[0], "far", (const char *const[]){"node", "anna", NULL}, fds, NULL));
    assert_true(launch_request_receive(&request, ends.sockets[1], NULL));
    assert_string_equal(request.pool, "far");
    assert_string_equal(request.words[0], "node");
    assert_string_equal(request.words[1], "anna");
    assert_null(request.words[2]);
    for (int i = 1; i < 3; i++) {
        assert_int_equal(write(request.fds[i], &"xyz"[i], 1), 1);
        assert_int_equal(read(ends.pipes[i][0], &byte, 1), 1);
        assert_int_equal(byte, "xyz"[i]);
    }
    assert_int_equal(fcntl(request.fds[0], F_GETFD), FD_CLOEXEC);
    launch_request_finish(&request);
    assert_int_equal(next_fd(), before);
    close_ends(&ends);
}

static void pipes_in_the_wrong_direction_are_refused(void **state)
{
    struct ends ends = open_ends();
    const int fds[] = {ends.pipes[0][0], ends.pipes[1][0], ends.pipes[2][1]};
    struct launch_request request;
    struct error error = {0};
    int before = next_fd();

    assert_true(launch_request_send(ends.sockets[0], "far", (const char *const[]){"node", NULL}, fds, NULL));
    assert_false(launch_request_receive(&request, ends.sockets[1], &error));
    assert_string_equal(error.message, "expected the ends of three pipes");
    assert_int_equal(next_fd(), before);
    close_ends(&ends);
}

static void more_words_than_any_command_has_are_refused(void **state)
{
    struct ends ends = open_ends();
    const int fds[] = {ends.pipes[0][0], ends.pipes[1][1], ends.pipes[2][1]};
    const char *words[POOL_COMMAND_WORD_LIMIT + 2] = {NULL};
    struct launch_request request;
    struct error error = {0};
    int before = next_fd();

    for (int i = 0; i <= POOL_COMMAND_WORD_LIMIT; i++)
        words[i] = "";
    assert_true(launch_request_send(ends.sockets[0], "far", words, fds, NULL));
    assert_false(launch_request_receive(&request, ends.sockets[1], &error));
    assert_string_equal(error.message, "expected at most 8 words");
    assert_int_equal(next_fd(), before);
    close_ends(&ends);
}

static void a_closed_connection_is_no_request(void **state)
{
    struct ends ends = open_ends();
    struct launch_request request;
    struct error error = {0};

    shutdown(ends.sockets[0], SHUT_WR);
    assert_false(launch_request_receive(&request, ends.sockets[1], &error));
    close_ends(&ends);
}

static void words_that_are_too_long_are_not_sent(void **state)
{
    struct ends ends = open_ends();
    const int fds[] = {ends.pipes[0][0], ends.pipes[1][1], ends.pipes[2][1]};
    char word[LAUNCH_REQUEST_SIZE];
    struct error error = {0};

    memset(word, 'x', sizeof word - 1);
    word[sizeof word - 1] = '\0';
    assert_false(launch_request_send(ends.sockets[0], "far", (const char *const[]){word, NULL}, fds, &error));
    assert_string_equal(error.message, "expected at most 4096 bytes in all words");
    close_ends(&ends);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_request_arrives_with_its_pipes),
        cmocka_unit_test(pipes_in_the_wrong_direction_are_refused),
        cmocka_unit_test(more_words_than_any_command_has_are_refused),
        cmocka_unit_test(a_closed_connection_is_no_request),
        cmocka_unit_test(words_that_are_too_long_are_not_sent),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
