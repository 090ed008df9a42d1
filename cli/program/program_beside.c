// SPDX-License-Identifier: Apache-2.0
#include "cli/program/program_beside.h"

#include "core/base/alloc.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ARGUMENT_LIMIT = 8 };

char *program_beside_find(const char *name)
{
    char own[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", own, sizeof own - 1);

    own[length < 0 ? 0 : length] = 0;
    if (strrchr(own, '/')) *strrchr(own, '/') = 0;
    return xasprintf("%s/%s", own, name);
}

static bool start(pid_t *pid, const char *path, const char *argument, int out)
{
    char *const arguments[] = {(char *)path, (char *)argument, NULL};
    posix_spawn_file_actions_t actions;
    bool ok;

    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    ok = posix_spawn(pid, path, &actions, NULL, arguments, environ) == 0;
    posix_spawn_file_actions_destroy(&actions);
    return ok;
}

static char *read_to_end(int fd)
{
    char *text = NULL;
    size_t size = 0;
    FILE *in = fdopen(fd, "r");

    if (!in) {
        close(fd);
        return NULL;
    }
    if (getdelim(&text, &size, 0, in) < 0) {
        free(text);
        text = NULL;
    }
    fclose(in);
    return text;
}

int program_beside_run(const char *name, const char *const arguments[], bool is_quiet)
{
    char *path = program_beside_find(name);
    char *argv[ARGUMENT_LIMIT + 2] = {path};
    posix_spawn_file_actions_t actions;
    int status = -1;
    pid_t pid;

    for (size_t i = 0; i < ARGUMENT_LIMIT && arguments[i]; i++)
        argv[i + 1] = (char *)arguments[i];
    posix_spawn_file_actions_init(&actions);
    if (is_quiet) posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (posix_spawn(&pid, path, &actions, NULL, argv, environ) == 0)
        while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
        }
    posix_spawn_file_actions_destroy(&actions);
    free(path);
    return status >= 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

char *program_beside_ask(const char *name, const char *argument)
{
    char *path = program_beside_find(name), *text = NULL;
    int fds[2], status = -1;
    pid_t pid;

    if (pipe2(fds, O_CLOEXEC) != 0) goto out;
    if (start(&pid, path, argument, fds[1])) {
        close(fds[1]);
        text = read_to_end(fds[0]);
        while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
        }
    } else {
        close(fds[0]);
        close(fds[1]);
    }
    if (status != 0) {
        free(text);
        text = NULL;
    }
out:
    free(path);
    return text;
}
