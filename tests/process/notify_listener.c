// notify-listener SOCKET: plays the service manager: what it is told comes out, a line for each notification.
// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>

int main(int argc, char **argv)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    char text[4096];
    ssize_t count;

    if (argc != 2 || strlen(argv[1]) >= sizeof address.sun_path) {
        fputs("usage: notify-listener SOCKET\n", stderr);
        return 2;
    }
    strcpy(address.sun_path, argv[1]);
    if (fd < 0 || bind(fd, (struct sockaddr *)&address, sizeof address) != 0) {
        perror(argv[1]);
        return 1;
    }
    while ((count = recv(fd, text, sizeof text - 1, 0)) >= 0) {
        text[count] = '\0';
        for (char *at = text; *at; at++)
            if (*at == '\n') *at = ' ';
        puts(text);
        fflush(stdout);
    }
    return 0;
}
