// socket-client SOCKET: standard input goes to the socket, what comes from it to standard output, until the peer closes.
// At the end of the input it says that it sends no more.
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
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

// False when there is nothing more to copy.
static bool copy(int from, int to)
{
    char bytes[65536];
    ssize_t count = read(from, bytes, sizeof bytes);

    return count > 0 && write_all(to, bytes, (size_t)count);
}

int main(int argc, char **argv)
{
    int fd = argc == 2 ? connect_to(argv[1]) : -1;
    struct pollfd polled[2] = {{.fd = fd, .events = POLLIN}, {.fd = STDIN_FILENO, .events = POLLIN}};

    if (fd < 0) {
        perror(argc == 2 ? argv[1] : "usage: socket-client SOCKET");
        return 1;
    }
    signal(SIGPIPE, SIG_IGN);
    while (poll(polled, 2, -1) >= 0) {
        if (polled[0].revents && !copy(fd, STDOUT_FILENO)) break;
        if (polled[1].revents && !copy(STDIN_FILENO, fd)) {
            shutdown(fd, SHUT_WR);
            polled[1].fd = -1;
        }
    }
    close(fd);
    return 0;
}
