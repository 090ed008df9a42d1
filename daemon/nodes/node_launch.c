// SPDX-License-Identifier: Apache-2.0
#include "daemon/nodes/node_launch.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { KILL_MS = 3000 };

struct node_launch {
    uv_process_t process;
    uv_pipe_t errors;
    uv_timer_t killer;
    int open_handles;
    node_launch_on_text *on_text; // NULL: nobody listens
    void *user;
    char text[NODE_LAUNCH_TEXT_SIZE]; // of the line that is being read
    size_t length;
    char last[NODE_LAUNCH_TEXT_SIZE];
    char end[64];
    bool has_exited, is_ending;
};

// Variables that a launcher needs to find its way and its keys. Nothing else of the daemon's is passed on.
static const char *const kept_names[] = {
    "PATH=",         "HOME=",         "USER=",          "LOGNAME=",    "LANG=",       "LC_",
    "TZ=",           "TMPDIR=",       "SSH_AUTH_SOCK=", "SLURM_CONF=", "KRB5CCNAME=", "LD_LIBRARY_PATH=",
    "ASAN_OPTIONS=", "LSAN_OPTIONS=", "UBSAN_OPTIONS="};

// Borrows the variables; the array itself is the caller's.
static char **make_environment(void)
{
    size_t count = 0, kept = 0;
    char **environment;

    while (environ[count])
        count++;
    environment = xcalloc(count + 1, sizeof environment[0]);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < sizeof kept_names / sizeof kept_names[0]; k++)
            if (strncmp(environ[i], kept_names[k], strlen(kept_names[k])) == 0) environment[kept++] = environ[i];
    return environment;
}

static void take_text(struct node_launch *launch, const char *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        bool is_end = bytes[i] == '\n' || bytes[i] == '\r' || launch->length == sizeof launch->text - 1;

        if (!is_end) launch->text[launch->length++] = bytes[i];
        if (!is_end || launch->length == 0) continue;
        launch->text[launch->length] = '\0';
        memcpy(launch->last, launch->text, launch->length + 1);
        launch->length = 0;
        if (launch->on_text) launch->on_text(launch->user, launch->last);
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
    uv_close((uv_handle_t *)&launch->process, on_closed);
    uv_close((uv_handle_t *)&launch->errors, on_closed);
    uv_close((uv_handle_t *)&launch->killer, on_closed);
}

static void on_exit_seen(uv_process_t *process, int64_t status, int signal)
{
    struct node_launch *launch = process->data;

    launch->has_exited = true;
    if (signal)
        snprintf(launch->end, sizeof launch->end, "the launcher was ended by signal %d", signal);
    else
        snprintf(launch->end, sizeof launch->end, "the launcher ended with exit status %lld", (long long)status);
    if (launch->is_ending) close_handles(launch);
}

static bool open_pipes(int in[2], int out[2], struct error *error)
{
    if (pipe2(in, O_CLOEXEC) == 0) {
        if (pipe2(out, O_CLOEXEC) == 0) return true;
        close(in[0]);
        close(in[1]);
    }
    error_set_errno(error, errno, "pipe");
    return false;
}

struct node_launch *node_launch_start(uv_loop_t *loop, char *const command[], node_launch_on_text *on_text, void *user,
                                      struct node_launch_fds *fds, struct error *error)
{
    struct node_launch *launch;
    char **environment;
    int in[2], out[2], status;
    uv_process_options_t options = {
        .exit_cb = on_exit_seen, .file = command[0], .args = (char **)command, .flags = UV_PROCESS_DETACHED};

    if (!open_pipes(in, out, error)) return NULL;
    launch = xcalloc(1, sizeof *launch);
    environment = make_environment();
    launch->on_text = on_text;
    launch->user = user;
    launch->open_handles = 3;
    uv_pipe_init(loop, &launch->errors, 0);
    uv_timer_init(loop, &launch->killer);
    launch->process.data = launch->errors.data = launch->killer.data = launch;
    options.stdio_count = 3;
    options.stdio = (uv_stdio_container_t[]){
        {.flags = UV_INHERIT_FD, .data.fd = out[0]},
        {.flags = UV_INHERIT_FD, .data.fd = in[1]},
        {.flags = UV_CREATE_PIPE | UV_WRITABLE_PIPE, .data.stream = (uv_stream_t *)&launch->errors}};
    options.env = environment;
    status = uv_spawn(loop, &launch->process, &options);
    free(environment);
    close(out[0]);
    close(in[1]);
    *fds = (struct node_launch_fds){.in = in[0], .out = out[1]};
    if (status == 0) {
        uv_read_start((uv_stream_t *)&launch->errors, on_allocate, on_read);
        return launch;
    }
    error_set(error, "%s: %s", command[0], uv_strerror(status));
    close(fds->in);
    close(fds->out);
    close_handles(launch);
    return NULL;
}

const char *node_launch_last_text(struct node_launch *launch)
{
    char bytes[4096];
    ssize_t count;
    int fd;

    // What it said before its end may still wait: the loop reads pipes in any order.
    while (uv_fileno((uv_handle_t *)&launch->errors, &fd) == 0 && (count = read(fd, bytes, sizeof bytes)) > 0)
        take_text(launch, bytes, (size_t)count);
    return launch->last;
}

const char *node_launch_format_end(struct node_launch *launch)
{
    return launch->has_exited ? launch->end : NULL;
}

static void on_kill(uv_timer_t *timer)
{
    struct node_launch *launch = timer->data;

    if (!launch->has_exited) (void)kill(-uv_process_get_pid(&launch->process), SIGKILL);
}

void node_launch_end(struct node_launch *launch)
{
    launch->on_text = NULL;
    if (launch->has_exited) {
        close_handles(launch);
        return;
    }
    launch->is_ending = true;
    uv_process_kill(&launch->process, SIGTERM);
    uv_timer_start(&launch->killer, on_kill, KILL_MS, 0);
}
