// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_child.h"

#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/wire/worker_status.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    CHANNEL_FD = 3,
    NICENESS = 10,
    END_MS = 1000, // for which a process that was killed is waited for
    LOOK_MS = 100, // how often it is asked whether all ends
    IO_CLASS_BEST_EFFORT = 2,
    IO_CLASS_SHIFT = 13,
    IO_LAST = 7
};

struct start {
    const char *program;
    char *const *arguments, *const *environment;
    int fd;
    struct rlimit file, core;
};

// Between fork and exec only calls that are safe in a process of several threads.
static void become_worker(const struct start *start)
{
    int null_fd = open("/dev/null", O_RDWR);
    sigset_t none;

    // Its words are no lines of our log.
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        (void)dup2(null_fd, fd);
    (void)setpriority(PRIO_PROCESS, 0, NICENESS);
    (void)syscall(SYS_ioprio_set, 1, 0, IO_CLASS_BEST_EFFORT << IO_CLASS_SHIFT | IO_LAST);
    (void)setrlimit(RLIMIT_FSIZE, &start->file);
    (void)setrlimit(RLIMIT_CORE, &start->core);
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    signal(SIGPIPE, SIG_DFL);
    if (start->fd == CHANNEL_FD)
        (void)fcntl(CHANNEL_FD, F_SETFD, 0);
    else
        (void)dup2(start->fd, CHANNEL_FD);
    execve(start->program, start->arguments, start->environment);
    _exit(127);
}

static pid_t start_worker(const struct picture_child_params *params, int fd)
{
    char memory[24];
    char *const arguments[] = {(char *)params->program, (char *)"--fd", (char *)"3",
                               (char *)"--backend",     (char *)"none", (char *)"--fenced",
                               (char *)"--memory",      memory,         NULL};
    char *const environment[] = {(char *)"PATH=/usr/bin:/bin", NULL};
    const struct start start = {.program = params->program,
                                .arguments = arguments,
                                .environment = environment,
                                .fd = fd,
                                .file = {(rlim_t)params->file_bytes, (rlim_t)params->file_bytes}};
    pid_t pid;

    snprintf(memory, sizeof memory, "%lld", (long long)params->memory_bytes);
    pid = fork();
    if (pid == 0) become_worker(&start);
    return pid;
}

struct words {
    const char *text;
    size_t count;
};

// False: it has not ended, as a disk holds it fast, and will when the disk lets go.
static bool end_worker(pid_t pid, int *status)
{
    (void)kill(pid, SIGKILL);
    for (int i = 0; i < END_MS; i++) {
        if (waitpid(pid, status, WNOHANG) != 0) return true;
        usleep(1000);
    }
    return false;
}

// An end before the answer, which is the file's doing or the machine's.
static enum picture_status explain_end(struct picture_child *child, pid_t pid, struct error *error)
{
    int status = 0;
    bool has_ended = false;

    // It closed its channel and is about to end; it is not waited for long.
    for (int i = 0; i < LOOK_MS && !has_ended; i++) {
        has_ended = waitpid(pid, &status, WNOHANG) == pid;
        if (!has_ended) usleep(1000);
    }
    if (!has_ended && !end_worker(pid, &status)) child->left = pid;
    if (WIFEXITED(status) && WEXITSTATUS(status) == WORKER_STATUS_MEMORY)
        error_set(error, "it takes more memory than a worker may have here");
    else if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
        error_set(error, "the worker cannot be started");
    else if (WIFSIGNALED(status))
        error_set(error, "the worker was ended by signal %d (%s)", WTERMSIG(status), sigdescr_np(WTERMSIG(status)));
    else
        error_set(error, "the worker ended with status %d", WEXITSTATUS(status));
    return PICTURE_FAULT;
}

static int64_t now_ms(void)
{
    return (int64_t)(1000.0 * clock_now_s());
}

static bool is_answer(const char *line, size_t length)
{
    static const char start[] = "{\"jsonrpc\":\"2.0\",\"id\":1,";

    return length >= strlen(start) && !strncmp(line, start, strlen(start));
}

// worker.failed says why a fence cannot be had: the last line before the end.
static bool is_failure(const char *line, size_t length)
{
    return memmem(line, length, "\"worker.failed\"", strlen("\"worker.failed\"")) != NULL;
}

// PICTURE_READY with the answer's line in `child`; PICTURE_FAULT with an empty error: the channel ended.
static enum picture_status receive(struct picture_child *child, const struct picture_child_params *params, int fd,
                                   struct error *error)
{
    for (;;) {
        struct pollfd ready = {.fd = fd, .events = POLLIN};
        int64_t left_ms = child->ends_ms - now_ms();
        size_t room;
        char *bytes;
        ssize_t count;

        while ((child->line = message_stream_next(&child->stream, &child->length, error)))
            if (is_answer(child->line, child->length) || is_failure(child->line, child->length)) return PICTURE_READY;
        if (error->message[0]) return PICTURE_FAULT;
        if (left_ms <= 0) {
            error_set(error, "it took longer than %d s", params->limit_ms / 1000);
            return PICTURE_SLOW;
        }
        if (params->is_stopped && atomic_load(params->is_stopped)) {
            error_set(error, "march-web ends");
            return PICTURE_BUSY;
        }
        if (poll(&ready, 1, left_ms < LOOK_MS ? (int)left_ms : LOOK_MS) <= 0) continue;
        bytes = message_stream_reserve(&child->stream, &room);
        count = recv(fd, bytes, room, 0);
        if (count <= 0 && !(count < 0 && errno == EINTR)) return PICTURE_FAULT;
        if (count > 0) message_stream_commit(&child->stream, (size_t)count);
    }
}

static bool is_given_up(const struct picture_child *child, const struct picture_child_params *params)
{
    return now_ms() >= child->ends_ms || (params->is_stopped && atomic_load(params->is_stopped));
}

// A worker that does not read is not waited for longer than for its answer, and receive says so.
static bool send_all(const struct picture_child *child, const struct picture_child_params *params, int fd,
                     const struct words *words)
{
    size_t done = 0;

    while (done < words->count && !is_given_up(child, params)) {
        struct pollfd ready = {.fd = fd, .events = POLLOUT};
        ssize_t sent = send(fd, words->text + done, words->count - done, MSG_NOSIGNAL | MSG_DONTWAIT);

        if (sent > 0)
            done += (size_t)sent;
        else if (errno != EINTR && errno != EAGAIN)
            return false;
        else
            (void)poll(&ready, 1, LOOK_MS);
    }
    return true;
}

enum picture_status picture_child_ask(struct picture_child *child, const struct picture_child_params *params,
                                      const char *words, size_t count, struct error *error)
{
    enum picture_status status = PICTURE_FAULT;
    struct error found = {0};
    int fds[2];
    pid_t pid;

    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds) != 0) {
        error_set_errno(error, errno, "no socket pair");
        return status;
    }
    pid = start_worker(params, fds[1]);
    close(fds[1]);
    if (pid < 0) {
        error_set_errno(error, errno, "no process for the worker");
        close(fds[0]);
        return status;
    }
    child->ends_ms = now_ms() + params->limit_ms;
    if (send_all(child, params, fds[0], &(struct words){words, count})) status = receive(child, params, fds[0], &found);
    if (status == PICTURE_FAULT && !found.message[0])
        explain_end(child, pid, &found);
    else if (!end_worker(pid, &(int){0}))
        child->left = pid;
    close(fds[0]);
    if (found.message[0]) error_set(error, "%s", found.message);
    return status;
}

const char *picture_child_answer(const struct picture_child *child, size_t *length)
{
    *length = child->length;
    return child->line;
}

void picture_child_finish(struct picture_child *child)
{
    message_stream_finish(&child->stream);
    *child = (struct picture_child){0};
}
