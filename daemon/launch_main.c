// march-launch: starts the launchers of the pools, ssh and others, for a daemon that has no network.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/log.h"
#include "core/base/version.h"
#include "daemon/launch/launch_serve.h"

#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <systemd/sd-daemon.h>

enum { EXIT_USAGE = 2, BACKLOG = 4096 };

static const char help[] =
    "usage: march-launch [options]\n"
    "\n"
    "Starts the launchers of a daemon's pools, which the daemon asks for because it has no network itself.\n"
    "It runs as the daemon's user, serves that user alone, and starts only what the pools of the file say.\n"
    "\n"
    "  --config PATH           the daemon's file of settings (/etc/marchd/marchd.conf)\n"
    "  --socket PATH           where the daemon asks, launch-socket of its settings; a socket that systemd hands over\n"
    "                          takes precedence\n"
    "  --help, --version\n";

static const struct option long_options[] = {{"config", required_argument, NULL, 'c'},
                                             {"socket", required_argument, NULL, 's'},
                                             {"help", no_argument, NULL, 'h'},
                                             {"version", no_argument, NULL, 'v'},
                                             {NULL, 0, NULL, 0}};

// -1 on failure, which is told.
static int open_socket(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    struct stat stat;
    bool is_open;
    mode_t mask;
    int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);

    if (fd < 0 || strlen(path) >= sizeof address.sun_path) {
        log_error("socket %s: expected a path of at most %zu bytes", path, sizeof address.sun_path - 1);
        return -1;
    }
    strcpy(address.sun_path, path);
    // What an earlier march-launch left.
    if (lstat(path, &stat) == 0 && S_ISSOCK(stat.st_mode)) unlink(path);
    mask = umask(0177);
    is_open = bind(fd, (struct sockaddr *)&address, sizeof address) == 0 && listen(fd, BACKLOG) == 0;
    if (!is_open) log_error("socket %s: %s", path, strerrordesc_np(errno));
    umask(mask);
    return is_open ? fd : -1;
}

static int find_socket(const char *path)
{
    if (sd_listen_fds(1) >= 1) {
        if (sd_is_socket_unix(SD_LISTEN_FDS_START, SOCK_SEQPACKET, 1, NULL, 0) > 0) return SD_LISTEN_FDS_START;
        log_error("the socket from systemd: expected ListenSequentialPacket=");
        return -1;
    }
    if (path) return open_socket(path);
    log_error("expected --socket PATH, or a socket from systemd: see march-launch --help");
    return -1;
}

// A process for each connection: it ends with us, and what it has started with it.
static void serve(int parent, int listening, int connection, const char *config_path)
{
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) exit(EXIT_FAILURE); // it was gone before
    signal(SIGCHLD, SIG_DFL);
    close(listening);
    launch_serve(connection, config_path);
    exit(EXIT_SUCCESS);
}

static void accept_all(int listening, const char *config_path)
{
    const struct timespec pause = {.tv_nsec = 100 * 1000 * 1000};
    int own = getpid();

    for (;;) {
        int connection = accept4(listening, NULL, NULL, SOCK_CLOEXEC), process;

        if (connection < 0 && (errno == EINTR || errno == ECONNABORTED)) continue;
        process = connection < 0 ? -1 : fork();
        if (process == 0) serve(own, listening, connection, config_path);
        if (process < 0) {
            log_warn("a connection is not served: %s", strerrordesc_np(errno));
            nanosleep(&pause, NULL);
        }
        if (connection >= 0) close(connection);
    }
}

// Owned by the caller.
static char *make_absolute(const char *path)
{
    char folder[PATH_MAX];

    return *path == '/' || !getcwd(folder, sizeof folder) ? xstrdup(path) : xasprintf("%s/%s", folder, path);
}

int main(int argc, char **argv)
{
    const char *config_path = "/etc/marchd/marchd.conf", *path = NULL;
    int code, listening;

    while ((code = getopt_long(argc, argv, "", long_options, NULL)) != -1) {
        if (code == 'h') return fputs(help, stdout) < 0;
        if (code == 'v') {
            version_print(stdout, "march-launch");
            return EXIT_SUCCESS;
        }
        if (code == '?') return EXIT_USAGE;
        *(code == 'c' ? &config_path : &path) = optarg;
    }
    if (optind < argc) {
        log_error("%s: expected options only, see --help", argv[optind]);
        return EXIT_USAGE;
    }
    listening = find_socket(path);
    if (listening < 0) return EXIT_FAILURE;
    signal(SIGCHLD, SIG_IGN); // children leave no zombies
    accept_all(listening, make_absolute(config_path));
}
