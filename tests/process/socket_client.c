// socket-client [--keep] SOCKET: standard input goes to the socket, what comes from it to standard output.
// SPDX-License-Identifier: Apache-2.0
// It ends when the peer closes. At the end of the input it says that it sends no more, unless told to keep the
// connection as it is.
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

static int connect_to(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

    if (strlen(path) >= sizeof address.sun_path) return -1;
    strcpy(address.sun_path, path);
    return fd >= 0 && connect(fd, (struct sockaddr *)&address, sizeof address) == 0 ? fd : -1;
}

static bool write_all(int fd, const char *bytes, size_t size_bytes)
{
    while (size_bytes > 0) {
        ssize_t count = write(fd, bytes, size_bytes);

        if (count <= 0) return false;
        bytes += count;
        size_bytes -= (size_t)count;
    }
    return true;
}

static void copy_all(int from, int to)
{
    char bytes[65536];
    ssize_t count;

    do {
        count = read(from, bytes, sizeof bytes);
    } while (count > 0 && write_all(to, bytes, (size_t)count));
}

int main(int argc, char **argv)
{
    bool keeps = argc == 3 && strcmp(argv[1], "--keep") == 0;
    int fd = argc == 2 || keeps ? connect_to(argv[argc - 1]) : -1;
    pid_t writer;

    if (fd < 0) {
        perror(argc == 2 || keeps ? argv[argc - 1] : "usage: socket-client [--keep] SOCKET");
        return 1;
    }
    signal(SIGPIPE, SIG_IGN);
    // Two processes, for a peer that waits until its answers are read must not keep them from being read.
    writer = fork();
    if (writer == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        copy_all(STDIN_FILENO, fd);
        if (!keeps) shutdown(fd, SHUT_WR);
        return 0;
    }
    copy_all(fd, STDOUT_FILENO);
    kill(writer, SIGKILL);
    return 0;
}
