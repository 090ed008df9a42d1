// SPDX-License-Identifier: Apache-2.0
#include "tests/support/test_worker.h"

#include "core/base/error.h"
#include "tests/support/folders.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

// Generous: sanitizers, and other processes on the same cores.
// Guards against what never happens: machines are slow and busy.
enum { MESSAGE_TIMEOUT_MS = 600 * 1000, EXIT_TIMEOUT_MS = 600 * 1000 };

void test_worker_start(struct test_worker *child, const char *backend, const char *device)
{
    const char *const options[] = {"--backend", backend, device ? "--device" : NULL, device, NULL};

    test_worker_start_with(child, options);
}

void test_worker_start_with(struct test_worker *child, const char *const options[])
{
    const char *arguments[16] = {"march-worker", "--fd"};
    int fds[2];
    char number[16];

    *child = (struct test_worker){.root = "/tmp/worker_process_test_XXXXXX"};
    assert_non_null(mkdtemp(child->root));
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds), 0);
    child->fd = fds[0];
    child->pid = fork();
    assert_true(child->pid >= 0);
    if (child->pid == 0) {
        fcntl(fds[1], F_SETFD, 0);
        snprintf(number, sizeof number, "%d", fds[1]);
        arguments[2] = number;
        for (size_t i = 0; options[i] && i + 4 < sizeof arguments / sizeof arguments[0]; i++)
            arguments[3 + i] = options[i];
        execv(PROGRAM_FOLDER "/march-worker", (char *const *)arguments);
        _exit(127);
    }
    close(fds[1]);
}

void test_worker_say(const struct test_worker *child, const char *format, ...)
{
    va_list arguments;
    char *text;
    int length;
    ssize_t sent;

    va_start(arguments, format);
    length = vasprintf(&text, format, arguments);
    va_end(arguments);
    assert_true(length > 0);
    text[length] = '\n';
    sent = send(child->fd, text, (size_t)length + 1, MSG_NOSIGNAL);
    // A worker that refuses a message ends before it reads the next.
    assert_true(sent == length + 1 || (sent < 0 && (errno == EPIPE || errno == ECONNRESET)));
    free(text);
}

bool test_worker_hear(struct test_worker *child, struct message *message)
{
    const char *line;
    size_t length, room;
    enum message_code code;
    struct error error = {0};

    while (!(line = message_stream_next(&child->stream, &length, &error))) {
        struct pollfd ready = {.fd = child->fd, .events = POLLIN};
        char *bytes = message_stream_reserve(&child->stream, &room);
        ssize_t count;

        if (poll(&ready, 1, MESSAGE_TIMEOUT_MS) != 1) fail_msg("the worker says nothing");
        count = recv(child->fd, bytes, room, 0);
        if (count <= 0) return false;
        message_stream_commit(&child->stream, (size_t)count);
    }
    if (!message_decode(message, line, length, &code, &error)) fail_msg("%s", error.message);
    return true;
}

struct message test_worker_expect(struct test_worker *child, const char *method)
{
    static const char *const passed_over[] = {"worker.beat",    "frame.phase",   "frame.started",
                                              "frame.planning", "frame.planned", "frame.rendered"};
    struct message message;

    for (;;) {
        bool is_passed_over = false;

        if (!test_worker_hear(child, &message)) fail_msg("expected %s, got the end", method);
        if (message.kind == MESSAGE_NOTIFICATION && !strcmp(message.method, method)) return message;
        for (size_t i = 0; i < sizeof passed_over / sizeof passed_over[0]; i++)
            is_passed_over |= message.kind == MESSAGE_NOTIFICATION && !strcmp(message.method, passed_over[i]);
        if (!is_passed_over) fail_msg("expected %s, got %s", method, message.method ? message.method : "an answer");
        message_finish(&message);
    }
}

int64_t test_worker_integer_of(const struct message *message, const char *key)
{
    struct json_node node = json_node_child(&message->body, key);
    int64_t integer = -1;

    assert_true(json_read_integer(&node, 0, INT64_MAX, &integer, NULL));
    return integer;
}

const char *test_worker_text_of(const struct message *message, const char *key)
{
    struct json_node node = json_node_child(&message->body, key);
    const char *text = "";

    assert_true(json_read_string(&node, &text, NULL));
    return text;
}

void test_worker_expect_frame(struct test_worker *child, const char *method, int frame)
{
    struct message message = test_worker_expect(child, method);

    assert_int_equal(test_worker_integer_of(&message, "frame"), frame);
    message_finish(&message);
}

void test_worker_expect_failure(struct test_worker *child, int frame, const char *fault, const char *reason)
{
    struct message message = test_worker_expect(child, "frame.failed");

    assert_int_equal(test_worker_integer_of(&message, "frame"), frame);
    assert_string_equal(test_worker_text_of(&message, "fault"), fault);
    if (!strstr(test_worker_text_of(&message, "error"), reason))
        fail_msg("expected \"%s\" in \"%s\"", reason, test_worker_text_of(&message, "error"));
    message_finish(&message);
}

static void remove_folder(const char *path)
{
    DIR *folder = opendir(path);
    struct dirent *entry;
    char inner[512];

    assert_non_null(folder);
    while ((entry = readdir(folder))) {
        if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, "..")) continue;
        snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name);
        if (unlink(inner) < 0) remove_folder(inner);
    }
    closedir(folder);
    rmdir(path);
}

int test_worker_finish(struct test_worker *child)
{
    int status = 0;
    pid_t ended = 0;

    for (int waited_ms = 0; waited_ms < EXIT_TIMEOUT_MS && !ended; waited_ms += 10) {
        ended = waitpid(child->pid, &status, WNOHANG);
        if (!ended) nanosleep(&(struct timespec){.tv_nsec = 10 * 1000 * 1000}, NULL);
    }
    if (!ended) {
        kill(child->pid, SIGKILL);
        waitpid(child->pid, &status, 0);
    }
    close(child->fd);
    message_stream_finish(&child->stream);
    remove_folder(child->root);
    return ended && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void test_worker_start_renderer(struct test_worker *child)
{
    struct message message;

    test_worker_start(child, "software", NULL);
    assert_true(test_worker_hear(child, &message));
    if (!strcmp(message.method, "worker.failed")) {
        print_message("no GL in software: %s\n", test_worker_text_of(&message, "error"));
        message_finish(&message);
        test_worker_finish(child);
        skip();
    }
    assert_string_equal(message.method, "worker.ready");
    if (strcmp(test_worker_text_of(&message, "backend"), "osmesa") != 0)
        assert_string_equal(test_worker_text_of(&message, "backend"), "egl");
    assert_int_equal(test_worker_integer_of(&message, "pid"), child->pid);
    message_finish(&message);
}
