// SPDX-License-Identifier: Apache-2.0
#include "daemon/launch/launch_serve.h"

#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/launch/launch_environment.h"
#include "daemon/launch/launch_request.h"
#include "daemon/settings/options.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { REQUEST_S = 10, KILL_MS = 3000, EXIT_NOT_STARTED = 127 };

static void answer(int socket, const char *text)
{
    (void)send(socket, text, strlen(text), MSG_NOSIGNAL);
}

static bool is_own_user(int socket)
{
    struct ucred peer = {0};
    socklen_t size = sizeof peer;

    if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.uid == geteuid()) return true;
    log_warn("a process of user %d is refused", (int)peer.uid);
    answer(socket, "march-launch serves only the user that it runs as");
    return false;
}

// NULL, with the reason, where the pools of the file allow no such command.
static char **find_command(const struct launch_request *request, const char *config_path, struct error *error)
{
    const struct options_surroundings surroundings = {.current_folder = "/", .program_folder = "/usr/bin"};
    char *line[] = {(char *)"march-launch", (char *)"--system", (char *)"--config", (char *)config_path, NULL};
    struct options options;
    char **command = NULL;

    if (!options_parse(&options, sizeof line / sizeof line[0] - 1, line, &surroundings, error)) return NULL;
    for (size_t i = 0; i < options.pools.count && !command && !error->message[0]; i++)
        if (strcmp(options.pools.pools[i].name, request->pool) == 0)
            command = pool_command_make(&options.pools.pools[i], request->words, error);
    if (!command && !error->message[0]) error_set(error, "there is no pool %s", request->pool);
    if (!command) error_prefix(error, "%s", config_path);
    options_finish(&options);
    return command;
}

static void run(int parent, char **command, const int fds[static 3])
{
    char **environment = launch_environment_make();

    setsid();
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(EXIT_NOT_STARTED); // it was gone before
    for (int i = 0; i < 3; i++)
        if (dup2(fds[i], i) < 0) _exit(EXIT_NOT_STARTED);
    execvpe(command[0], command, environment);
    dprintf(STDERR_FILENO, "march-launch: %s: %s\n", command[0], strerrordesc_np(errno));
    _exit(EXIT_NOT_STARTED);
}

static bool is_readable(int fd, int timeout_ms)
{
    struct pollfd waited = {.fd = fd, .events = POLLIN};

    return poll(&waited, 1, timeout_ms) > 0;
}

// Waits until the process ends, or ends it when the other end of the socket says anything or is closed.
static void wait_for(int process, int pidfd, int socket)
{
    struct pollfd waited[] = {{.fd = pidfd, .events = POLLIN}, {.fd = socket, .events = POLLIN}};

    while (poll(waited, 2, -1) < 0 && errno == EINTR) {
    }
    if (waited[0].revents) return;
    kill(process, SIGTERM);
    if (!is_readable(pidfd, KILL_MS)) kill(-process, SIGKILL);
}

static void tell_end(int socket, int status)
{
    char text[LAUNCH_END_SIZE];

    if (WIFSIGNALED(status))
        snprintf(text, sizeof text, "the launcher was ended by signal %d", WTERMSIG(status));
    else
        snprintf(text, sizeof text, LAUNCH_END_STATUS "%d", WEXITSTATUS(status));
    answer(socket, text);
}

// Takes over the request's descriptors.
static bool start_and_wait(struct launch_request *request, char **command, int socket, struct error *error)
{
    int own = getpid(), process = fork(), pidfd = -1, status = 0;

    if (process == 0) run(own, command, request->fds);
    if (process > 0) pidfd = pidfd_open(process, 0);
    if (process < 0 || pidfd < 0) error_set_errno(error, errno, "cannot start a process");
    if (process < 0) return false;
    // The streams end when the command's are closed.
    if (pidfd >= 0) launch_request_finish(request);
    if (pidfd >= 0)
        wait_for(process, pidfd, socket);
    else
        kill(process, SIGKILL);
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    if (pidfd < 0) return false;
    close(pidfd);
    tell_end(socket, status);
    return true;
}

void launch_serve(int socket, const char *config_path)
{
    const struct timeval limit = {.tv_sec = REQUEST_S};
    struct launch_request request;
    struct error error = {0};
    char **command;
    bool ok = false;

    if (!is_own_user(socket)) return;
    setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    if (!launch_request_receive(&request, socket, &error)) {
        log_warn("%s", error.message);
        answer(socket, "march-launch does not understand what it is asked for");
        return;
    }
    command = find_command(&request, config_path, &error);
    if (command) ok = start_and_wait(&request, command, socket, &error);
    pool_options_free_command(command);
    if (!ok) {
        log_warn("%s", error.message);
        dprintf(request.fds[2], "march-launch: %s\n", error.message);
        answer(socket, "march-launch refused it");
    }
    launch_request_finish(&request);
}
