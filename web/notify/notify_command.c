// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_command.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/wait.h>
#include <unistd.h>

enum { OUTPUT_LIMIT = 400 };

struct notify_command {
    pid_t pid;
    int pidfd, output_fd;
    int64_t deadline_ms;
    bool is_late;
    char output[OUTPUT_LIMIT + 1]; // its beginning
    size_t output_length;
    struct notify_line *line; // borrowed
};

static char search_path[] = "PATH=/usr/local/bin:/usr/bin:/bin", language[] = "LANG=C.UTF-8";
static char *const environment[] = {search_path, language, NULL};

// A file in memory, so that a command that does not read holds up nobody.
static int make_input(const char *body, struct error *error)
{
    int fd = memfd_create("notice", MFD_CLOEXEC);
    size_t length = strlen(body), done = 0;

    while (fd >= 0 && done < length) {
        ssize_t count = write(fd, body + done, length - done);

        if (count < 0 && errno == EINTR) continue;
        if (count < 0) break;
        done += (size_t)count;
    }
    if (fd >= 0 && done == length && lseek(fd, 0, SEEK_SET) == 0) return fd;
    error_set_errno(error, errno, "cannot keep the notice for the command");
    if (fd >= 0) close(fd);
    return -1;
}

static int spawn(pid_t *pid, char *const arguments[], int input_fd, int output_fd)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t all, none;
    int failure;

    sigfillset(&all);
    sigemptyset(&none);
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setsigmask(&attributes, &none);
    failure = posix_spawn_file_actions_addchdir_np(&actions, "/");
    if (!failure) failure = posix_spawn_file_actions_adddup2(&actions, input_fd, STDIN_FILENO);
    if (!failure) failure = posix_spawn_file_actions_adddup2(&actions, output_fd, STDOUT_FILENO);
    if (!failure) failure = posix_spawn_file_actions_adddup2(&actions, output_fd, STDERR_FILENO);
    if (!failure) failure = posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    if (!failure) failure = posix_spawn(pid, arguments[0], &actions, &attributes, arguments, environment);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return failure;
}

struct notify_command *notify_command_start(char *const arguments[], const char *body, int64_t deadline_ms,
                                            struct notify_line *line, struct error *error)
{
    struct notify_command *command = xcalloc(1, sizeof *command);
    int input_fd = make_input(body, error), pipe_fds[2] = {-1, -1}, failure = 0;

    command->pidfd = -1;
    command->deadline_ms = deadline_ms;
    command->line = line;
    if (input_fd >= 0 && pipe2(pipe_fds, O_CLOEXEC) != 0) failure = errno;
    if (input_fd >= 0 && !failure) failure = spawn(&command->pid, arguments, input_fd, pipe_fds[1]);
    if (failure) error_set_errno(error, failure, "cannot start %s", arguments[0]);
    command->output_fd = pipe_fds[0];
    if (pipe_fds[0] >= 0) fcntl(pipe_fds[0], F_SETFL, O_NONBLOCK); // our end alone
    if (pipe_fds[1] >= 0) close(pipe_fds[1]);
    if (input_fd >= 0) close(input_fd);
    if (command->pid > 0) command->pidfd = pidfd_open(command->pid, 0);
    if (command->pidfd >= 0) return command;
    if (command->pid > 0) error_set_errno(error, errno, "cannot watch %s", arguments[0]);
    notify_command_kill(command);
    return NULL;
}

void notify_command_list_fds(const struct notify_command *command, int fds[static NOTIFY_COMMAND_FDS])
{
    fds[0] = command->pidfd;
    fds[1] = command->output_fd >= 0 ? command->output_fd : command->pidfd;
}

int64_t notify_command_deadline_ms(const struct notify_command *command)
{
    return command->deadline_ms;
}

// Keeps the beginning of the output and drops the rest.
static void read_output(struct notify_command *command)
{
    char bytes[4096];

    for (int i = 0; i < 16 && command->output_fd >= 0; i++) {
        ssize_t count = read(command->output_fd, bytes, sizeof bytes);
        size_t room = OUTPUT_LIMIT - command->output_length;

        if (count < 0) return;
        if (count == 0) {
            close(command->output_fd);
            command->output_fd = -1;
            return;
        }
        if ((size_t)count < room) room = (size_t)count;
        memcpy(command->output + command->output_length, bytes, room);
        command->output_length += room;
    }
}

static void command_destroy(struct notify_command *command)
{
    if (command->output_fd >= 0) close(command->output_fd);
    if (command->pidfd >= 0) close(command->pidfd);
    free(command);
}

void notify_command_kill(struct notify_command *command)
{
    if (command->pid > 0) {
        kill(-command->pid, SIGKILL);
        kill(command->pid, SIGKILL); // its group is made by itself, a moment later
        waitpid(command->pid, NULL, 0);
    }
    command_destroy(command);
}

static void format_end(const struct notify_command *command, const siginfo_t *end, char *why, size_t size)
{
    char output[OUTPUT_LIMIT + 1];

    snprintf(output, sizeof output, "%s", command->output);
    output[strcspn(output, "\n")] = '\0';
    if (command->is_late)
        snprintf(why, size, "it took too long");
    else
        snprintf(why, size, "it ended with %s %d%s%s", end->si_code == CLD_EXITED ? "status" : "signal", end->si_status,
                 *output ? ": " : "", output);
}

bool notify_command_check(struct notify_command *command, int64_t now_ms, notify_on_end *on_end, void *user)
{
    char why[OUTPUT_LIMIT + 64];
    siginfo_t end = {0};
    struct notify_line *line = command->line;
    bool is_done;

    read_output(command);
    if (now_ms >= command->deadline_ms && !command->is_late) {
        command->is_late = true;
        kill(-command->pid, SIGKILL);
    }
    if (waitid(P_PID, (id_t)command->pid, &end, WEXITED | WNOHANG | WNOWAIT) != 0 || end.si_pid == 0) return false;
    kill(-command->pid, SIGKILL); // what it has left behind; the group exists until its leader is waited for
    waitid(P_PID, (id_t)command->pid, &end, WEXITED);
    read_output(command);
    is_done = end.si_code == CLD_EXITED && end.si_status == 0 && !command->is_late;
    format_end(command, &end, why, sizeof why);
    command_destroy(command);
    on_end(user, line, is_done ? NOTIFY_DELIVERED : NOTIFY_FAILED, is_done ? NULL : why);
    return true;
}
