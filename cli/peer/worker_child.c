// SPDX-License-Identifier: Apache-2.0
#include "cli/peer/worker_child.h"

#include "cli/peer/connection.h"
#include "cli/program/interrupt.h"
#include "cli/program/options.h"
#include "cli/program/program_beside.h"
#include "cli/terminal/progress.h"
#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { CHILD_FD = 3, ARGUMENT_LIMIT = 16, END_WAIT_MS = 5000, END_POLL_MS = 10 };

static char *find_program(const struct options *options, struct error *error)
{
    const char *environment = getenv("MARCH_WORKER");
    char *path;

    if (options->worker_program) {
        path = xstrdup(options->worker_program);
    } else if (environment && *environment) {
        path = xstrdup(environment);
    } else {
        path = program_beside_find("march-worker");
    }
    if (access(path, X_OK) == 0) return path;
    error_set_errno(error, errno, "%s: the worker cannot be started (--worker-program or $MARCH_WORKER names another)",
                    path);
    free(path);
    return NULL;
}

static void exec_child(const char *program, char *const arguments[], int fd, pid_t parent)
{
    sigset_t none;

    // A process group of its own: this program ends the child after it took its frames back, Ctrl-C in the terminal
    // does not.
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    signal(SIGPIPE, SIG_DFL);
    if (fd == CHILD_FD)
        fcntl(fd, F_SETFD, 0);
    else
        dup2(fd, CHILD_FD);
    dup2(STDERR_FILENO, STDOUT_FILENO); // stdout is for data of this program only
    execv(program, arguments);
    _exit(127);
}

static void fill_arguments(const struct options *options, const char *backend, char *program, char *threads,
                           size_t threads_size, char *arguments[ARGUMENT_LIMIT])
{
    size_t count = 0;

    arguments[count++] = program;
    arguments[count++] = (char *)"--fd";
    arguments[count++] = (char *)"3";
    arguments[count++] = (char *)"--backend";
    arguments[count++] = (char *)backend;
    if (options->device) {
        arguments[count++] = (char *)"--device";
        arguments[count++] = (char *)options->device;
    }
    if (options->shader_dir) {
        arguments[count++] = (char *)"--shader-dir";
        arguments[count++] = (char *)options->shader_dir;
    }
    if (options->encode_threads > 0) {
        snprintf(threads, threads_size, "%" PRId64, options->encode_threads);
        arguments[count++] = (char *)"--encode-threads";
        arguments[count++] = threads;
    }
    arguments[count] = NULL;
}

static bool start(struct worker_child *child, const struct options *options, const char *backend,
                  struct interrupt *interrupt, struct error *error)
{
    char *arguments[ARGUMENT_LIMIT];
    char threads[24];
    char *program = find_program(options, error);
    int fds[2] = {-1, -1};
    pid_t parent = getpid();

    memset(child, 0, sizeof *child);
    if (!program) return false;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds) != 0) {
        error_set_errno(error, errno, "no socket pair");
        free(program);
        return false;
    }
    fill_arguments(options, backend, program, threads, sizeof threads, arguments);
    fflush(NULL);
    child->pid = fork();
    if (child->pid == 0) exec_child(program, arguments, fds[1], parent);
    close(fds[1]);
    free(program);
    if (child->pid < 0) {
        error_set_errno(error, errno, "no process for the worker");
        close(fds[0]);
        child->pid = 0;
        return false;
    }
    child->connection = connection_adopt(fds[0], "march-worker");
    connection_set_interrupt(child->connection, interrupt);
    return true;
}

bool worker_child_start(struct worker_child *child, const struct options *options, struct interrupt *interrupt,
                        struct error *error)
{
    return start(child, options, options->backend ? options->backend : "auto", interrupt, error);
}

// Waits up to `limit_ms`; true when the child was reaped.
static bool reap(struct worker_child *child, int limit_ms, int *wait_status)
{
    const struct timespec pause = {.tv_nsec = END_POLL_MS * 1000000L};

    for (int waited_ms = 0;; waited_ms += END_POLL_MS) {
        pid_t pid = waitpid(child->pid, wait_status, WNOHANG);

        if (pid == child->pid || (pid < 0 && errno != EINTR)) break;
        if (waited_ms >= limit_ms) return false;
        nanosleep(&pause, NULL);
    }
    child->pid = 0;
    return true;
}

void worker_child_stop(struct worker_child *child, bool at_once)
{
    int wait_status;

    connection_close(child->connection);
    child->connection = NULL;
    if (child->pid <= 0) return;
    if (at_once) kill(child->pid, SIGKILL);
    if (reap(child, END_WAIT_MS, &wait_status)) return;
    kill(child->pid, SIGKILL);
    while (waitpid(child->pid, &wait_status, 0) < 0 && errno == EINTR)
        ;
    child->pid = 0;
}

void worker_child_explain_end(struct worker_child *child, struct error *error)
{
    int wait_status = 0;

    if (child->pid <= 0 || !reap(child, END_WAIT_MS, &wait_status)) return;
    if (WIFSIGNALED(wait_status))
        error_set(error, "march-worker was ended by signal %d (%s)", WTERMSIG(wait_status),
                  sigdescr_np(WTERMSIG(wait_status)));
    else
        error_set(error, "march-worker ended with exit status %d", WEXITSTATUS(wait_status));
}

// Looks for an error that the worker sent before it ended.
static void find_last_words(struct worker_child *child, struct error *error)
{
    struct message message;

    while (connection_next(child->connection, 0, &message, NULL) == CONNECTION_MESSAGE) {
        struct json_node text = json_node_child(&message.body, "error");
        const char *words;

        if (message.method && strcmp(message.method, "worker.failed") == 0 && json_read_string(&text, &words, NULL))
            error_set(error, "march-worker: %s", words);
        message_finish(&message);
    }
}

bool worker_child_start_without_gl(struct worker_child *child, const struct options *options,
                                   struct interrupt *interrupt, struct error *error)
{
    return start(child, options, "none", interrupt, error);
}

enum exit_status worker_child_call(struct worker_child *child, const char *method, const char *params,
                                   struct message *reply, struct error *error)
{
    enum exit_status status = EXIT_STATUS_DONE;

    if (connection_call(child->connection, method, params, reply, error)) return status;
    status = connection_failure(child->connection);
    if (status == EXIT_STATUS_NO_DAEMON) {
        status = EXIT_STATUS_FAILED;
        worker_child_explain_end(child, error);
        find_last_words(child, error);
    }
    return status;
}

enum { SHOWN_AFTER_MS = 2000 };

struct waiting {
    const char *label;
    int64_t start_ms;
    int64_t done, count; // parts of the work; 0: unknown
    double share;        // of the next part that is done; 0: unknown
    struct progress_display display;
};

static void note_parts(struct waiting *waiting, const struct message *message)
{
    struct json_node done = json_node_child(&message->body, "done"), count = json_node_child(&message->body, "count");
    struct json_node share = json_node_child(&message->body, "share");

    if (!message->method || strcmp(message->method, "request.progress") != 0) return;
    json_read_integer(&done, 0, INT32_MAX, &waiting->done, NULL);
    json_read_integer(&count, 0, INT32_MAX, &waiting->count, NULL);
    waiting->share = 0;
    json_read_number(&share, 0, 1, &waiting->share, NULL);
}

// Draws at each message that arrives; a busy worker sends one a second.
static void on_wait(void *user, const struct message *message)
{
    struct waiting *waiting = user;
    int64_t now_ms = progress_now_ms(), gone_s = (now_ms - waiting->start_ms) / 1000;
    char *duration = progress_format_duration((double)gone_s), *state;

    note_parts(waiting, message);
    if (waiting->share > 0)
        state = xasprintf("%.0f %% of the next, %s so far", 100 * waiting->share, duration);
    else
        state = xasprintf("%s so far", duration);
    if (now_ms - waiting->start_ms >= SHOWN_AFTER_MS)
        progress_display_draw(&waiting->display,
                              &(struct progress){.label = waiting->label,
                                                 .state = state,
                                                 .total = waiting->count,
                                                 .done = waiting->done,
                                                 .seconds_per_frame = -1,
                                                 .eta_s = -1},
                              1, now_ms, false);
    free(state);
    free(duration);
}

enum exit_status worker_child_ask(const struct options *options, const struct worker_question *question,
                                  struct message *reply, struct error *error)
{
    const char *backend = !question->needs_gl ? "none" : options->backend ? options->backend : "auto";
    struct interrupt interrupt;
    struct worker_child child;
    enum exit_status status = EXIT_STATUS_FAILED;

    interrupt_init(&interrupt);
    if (start(&child, options, backend, &interrupt, error)) {
        struct waiting waiting = {.label = question->label, .start_ms = progress_now_ms()};

        progress_display_init(&waiting.display, stderr);
        if (question->label) connection_set_wait(child.connection, on_wait, &waiting);
        status = worker_child_call(&child, question->method, question->params, reply, error);
        progress_display_clear(&waiting.display);
        worker_child_stop(&child, status != EXIT_STATUS_DONE);
    }
    interrupt_finish(&interrupt);
    return status;
}
