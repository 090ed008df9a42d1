// SPDX-License-Identifier: Apache-2.0
#include "daemon/nodes/node_launch.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/launch/launch_environment.h"
#include "daemon/launch/launch_request.h"
#include "daemon/settings/pool_command.h"
#include "daemon/settings/pool_options.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { READS_LIMIT = 16, KILL_MS = 3000, IN = 0, OUT = 1, ERRORS = 2, READ = 0, WRITE = 1 };

// Either a child of ours, or one of march-launch's.
struct node_launch {
    uv_process_t process;
    uv_timer_t killer;
    uv_poll_t answers; // of march-launch
    int socket;        // to march-launch; -1: the launcher is our child
    uv_pipe_t errors;
    int open_handles;
    node_launch_on_text *on_text; // NULL: nobody listens
    void *user;
    char text[NODE_LAUNCH_TEXT_SIZE]; // of the line that is being read
    size_t length;
    char last[NODE_LAUNCH_TEXT_SIZE];
    char end[LAUNCH_END_SIZE + 1];
    bool has_process, has_exited, is_ending;
};

// srun says at last that its task ended. What came before says why.
static bool is_news(const char *line)
{
    return strncmp(line, "srun: error: ", strlen("srun: error: ")) != 0 || !strstr(line, ": task 0: ");
}

static void take_text(struct node_launch *launch, const char *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        bool is_end = bytes[i] == '\n' || bytes[i] == '\r' || launch->length == sizeof launch->text - 1;

        if (!is_end) launch->text[launch->length++] = bytes[i];
        if (!is_end || launch->length == 0) continue;
        launch->text[launch->length] = '\0';
        if (is_news(launch->text)) memcpy(launch->last, launch->text, launch->length + 1);
        launch->length = 0;
        if (launch->on_text) launch->on_text(launch->user, launch->text);
    }
}

static void on_allocate(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    static char bytes[4096];

    *buffer = uv_buf_init(bytes, sizeof bytes);
}

static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer)
{
    if (count > 0) take_text(stream->data, buffer->base, (size_t)count);
    if (count < 0) {
        take_text(stream->data, "\n", 1);
        uv_read_stop(stream);
    }
}

static void on_closed(uv_handle_t *handle)
{
    struct node_launch *launch = handle->data;

    if (--launch->open_handles == 0) free(launch);
}

static void close_handles(struct node_launch *launch)
{
    uv_close((uv_handle_t *)&launch->errors, on_closed);
    if (launch->socket >= 0) {
        uv_close((uv_handle_t *)&launch->answers, on_closed);
        close(launch->socket);
    } else {
        if (launch->has_process) uv_close((uv_handle_t *)&launch->process, on_closed);
        uv_close((uv_handle_t *)&launch->killer, on_closed);
    }
}

static void on_exit_seen(uv_process_t *process, int64_t status, int signal)
{
    struct node_launch *launch = process->data;

    launch->has_exited = true;
    if (signal)
        snprintf(launch->end, sizeof launch->end, "the launcher was ended by signal %d", signal);
    else
        snprintf(launch->end, sizeof launch->end, LAUNCH_END_STATUS "%lld", (long long)status);
    if (launch->is_ending) close_handles(launch);
}

static void close_pipe(const int pipe[2])
{
    close(pipe[READ]);
    close(pipe[WRITE]);
}

static bool open_pipes(int pipes[3][2], struct error *error)
{
    for (int i = 0; i < 3; i++) {
        if (pipe2(pipes[i], O_CLOEXEC) == 0) continue;
        error_set_errno(error, errno, "pipe");
        while (i-- > 0)
            close_pipe(pipes[i]);
        return false;
    }
    return true;
}

static bool start_here(struct node_launch *launch, uv_loop_t *loop, const struct node_launch_order *order,
                       const int fds[static 3], struct error *error)
{
    char **command = pool_command_make(order->pool, order->words, error), **environment;
    uv_process_options_t options = {.exit_cb = on_exit_seen, .flags = UV_PROCESS_DETACHED, .stdio_count = 3};
    int status;

    uv_timer_init(loop, &launch->killer);
    launch->open_handles++;
    if (!command) return false;
    environment = launch_environment_make();
    options.file = command[0];
    options.args = command;
    options.env = environment;
    options.stdio = (uv_stdio_container_t[]){{.flags = UV_INHERIT_FD, .data.fd = fds[IN]},
                                             {.flags = UV_INHERIT_FD, .data.fd = fds[OUT]},
                                             {.flags = UV_INHERIT_FD, .data.fd = fds[ERRORS]}};
    status = uv_spawn(loop, &launch->process, &options);
    launch->has_process = true;
    launch->open_handles++;
    if (status != 0) error_set(error, "%s: %s", command[0], uv_strerror(status));
    free(environment);
    pool_options_free_command(command);
    return status == 0;
}

static void on_answer(uv_poll_t *poll, int status, int events)
{
    struct node_launch *launch = poll->data;
    ssize_t length = recv(launch->socket, launch->end, sizeof launch->end - 1, 0);

    if (length < 0 && errno == EAGAIN) return;
    launch->end[length > 0 ? length : 0] = '\0';
    if (length <= 0) snprintf(launch->end, sizeof launch->end, "march-launch ended");
    launch->has_exited = true;
    uv_poll_stop(poll);
}

static bool start_there(struct node_launch *launch, uv_loop_t *loop, const struct node_launch_order *order,
                        const int fds[static 3], struct error *error)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};

    uv_poll_init(loop, &launch->answers, launch->socket);
    launch->open_handles++;
    if (strlen(order->socket) >= sizeof address.sun_path) {
        error_set(error, "launch-socket %s: expected at most %zu bytes", order->socket, sizeof address.sun_path - 1);
        return false;
    }
    strcpy(address.sun_path, order->socket);
    if (connect(launch->socket, (struct sockaddr *)&address, sizeof address) != 0) {
        error_set_errno(error, errno, "march-launch, at %s", order->socket);
        return false;
    }
    if (!launch_request_send(launch->socket, order->pool->name, order->words, fds, error)) {
        error_prefix(error, "march-launch, at %s", order->socket);
        return false;
    }
    uv_poll_start(&launch->answers, UV_READABLE | UV_DISCONNECT, on_answer);
    return true;
}

static struct node_launch *start(uv_loop_t *loop, const struct node_launch_order *order, const int fds[static 3],
                                 int errors, struct error *error)
{
    struct node_launch *launch = xcalloc(1, sizeof *launch);
    bool ok;

    launch->socket = order->socket ? socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0) : -1;
    if (order->socket && launch->socket < 0) {
        error_set_errno(error, errno, "socket");
        close(errors);
        free(launch);
        return NULL;
    }
    launch->process.data = launch->answers.data = launch->errors.data = launch->killer.data = launch;
    uv_pipe_init(loop, &launch->errors, 0);
    launch->open_handles = 1;
    uv_pipe_open(&launch->errors, errors);
    ok = order->socket ? start_there(launch, loop, order, fds, error) : start_here(launch, loop, order, fds, error);
    if (ok) {
        uv_read_start((uv_stream_t *)&launch->errors, on_allocate, on_read);
        return launch;
    }
    close_handles(launch);
    return NULL;
}

struct node_launch *node_launch_start(uv_loop_t *loop, const struct node_launch_order *order,
                                      node_launch_on_text *on_text, void *user, struct node_launch_fds *fds,
                                      struct error *error)
{
    struct node_launch *launch;
    int pipes[3][2];

    if (!open_pipes(pipes, error)) return NULL;
    launch = start(loop, order, (int[]){pipes[IN][READ], pipes[OUT][WRITE], pipes[ERRORS][WRITE]}, pipes[ERRORS][READ],
                   error);
    close(pipes[IN][READ]);
    close(pipes[OUT][WRITE]);
    close(pipes[ERRORS][WRITE]);
    *fds = (struct node_launch_fds){.in = pipes[OUT][READ], .out = pipes[IN][WRITE]};
    if (launch) {
        launch->on_text = on_text;
        launch->user = user;
        return launch;
    }
    close(fds->in);
    close(fds->out);
    return NULL;
}

const char *node_launch_last_text(struct node_launch *launch)
{
    char bytes[4096];
    ssize_t count;
    int fd;

    if (uv_fileno((uv_handle_t *)&launch->errors, &fd) != 0) return launch->last;
    // What it said before its end may still wait: the loop reads pipes in any order.
    for (int i = 0; i < READS_LIMIT && (count = read(fd, bytes, sizeof bytes)) > 0; i++)
        take_text(launch, bytes, (size_t)count);
    return launch->last;
}

const char *node_launch_format_end(struct node_launch *launch)
{
    return launch->has_exited ? launch->end : NULL;
}

bool node_launch_has_succeeded(const struct node_launch *launch)
{
    return strcmp(launch->end, LAUNCH_END_WELL) == 0;
}

static void on_kill(uv_timer_t *timer)
{
    struct node_launch *launch = timer->data;

    if (!launch->has_exited) (void)kill(-uv_process_get_pid(&launch->process), SIGKILL);
}

void node_launch_end(struct node_launch *launch)
{
    launch->on_text = NULL;
    // march-launch ends it when the connection does.
    if (launch->has_exited || launch->socket >= 0) {
        close_handles(launch);
        return;
    }
    launch->is_ending = true;
    uv_process_kill(&launch->process, SIGTERM);
    uv_timer_start(&launch->killer, on_kill, KILL_MS, 0);
}
