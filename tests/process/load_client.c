// load-client SOCKET CONNECTIONS LINES: opens so many connections, sends the lines of a file on each at one moment.
// SPDX-License-Identifier: Apache-2.0
//   --unread    reads nothing, prints "ready" when all is sent, and keeps the connections until it is killed
// Otherwise it reads until each line is answered, and prints how many answers were results and how many errors.
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { CONNECTION_LIMIT = 1024, READ_BYTES = 1 << 16 };

struct connection {
    size_t sent;
    size_t answers;
};

struct load {
    char *text; // what each connection sends
    size_t length, lines;
    struct pollfd polls[CONNECTION_LIMIT];
    struct connection connections[CONNECTION_LIMIT];
    size_t count;
    size_t errors;
};

static int connect_to(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

    if (fd < 0 || strlen(path) >= sizeof address.sun_path) return -1;
    strcpy(address.sun_path, path);
    return connect(fd, (struct sockaddr *)&address, sizeof address) == 0 ? fd : -1;
}

static bool read_lines(struct load *load, const char *path)
{
    FILE *file = fopen(path, "r");
    size_t capacity = 1 << 16, count;

    if (!file) return false;
    do {
        load->text = realloc(load->text, capacity *= 2);
        if (!load->text) abort();
        count = fread(load->text + load->length, 1, capacity - load->length, file);
        load->length += count;
    } while (count > 0);
    fclose(file);
    for (size_t i = 0; i < load->length; i++)
        load->lines += load->text[i] == '\n';
    return load->lines > 0;
}

static bool send_some(struct load *load, size_t index)
{
    struct connection *connection = &load->connections[index];
    ssize_t count = send(load->polls[index].fd, load->text + connection->sent, load->length - connection->sent,
                         MSG_DONTWAIT | MSG_NOSIGNAL);

    if (count > 0) connection->sent += (size_t)count;
    return count > 0;
}

// Answers are told apart by their ends; an answer of these tests that has `"error":{` anywhere is one.
static bool receive_some(struct load *load, size_t index)
{
    static char bytes[READ_BYTES + 1];
    ssize_t count = recv(load->polls[index].fd, bytes, READ_BYTES, MSG_DONTWAIT);

    if (count <= 0) return false;
    bytes[count] = '\0';
    for (char *found = bytes; (found = strstr(found, "\"error\":{")); found++)
        load->errors++;
    for (ssize_t i = 0; i < count; i++)
        load->connections[index].answers += bytes[i] == '\n';
    return true;
}

static bool is_done(const struct load *load, bool unread)
{
    for (size_t i = 0; i < load->count; i++)
        if (load->connections[i].sent < load->length || (!unread && load->connections[i].answers < load->lines))
            return false;
    return true;
}

static bool run(struct load *load, bool unread)
{
    while (!is_done(load, unread)) {
        for (size_t i = 0; i < load->count; i++) {
            bool has_more = load->connections[i].sent < load->length;

            load->polls[i].events = (short)((has_more ? POLLOUT : 0) | (unread ? 0 : POLLIN));
        }
        if (poll(load->polls, load->count, -1) < 0) return false;
        for (size_t i = 0; i < load->count; i++) {
            short events = load->polls[i].revents;

            if ((events & POLLOUT) && !send_some(load, i)) return false;
            if ((events & POLLIN) && !receive_some(load, i)) return false;
            if (!(events & (POLLIN | POLLOUT)) && (events & (POLLERR | POLLHUP))) return false;
        }
    }
    return true;
}

int main(int argc, char **argv)
{
    static struct load load;
    bool unread = argc == 5 && strcmp(argv[1], "--unread") == 0;
    size_t answers = 0;

    if (argc != 4 + unread || !read_lines(&load, argv[argc - 1])) {
        fputs("usage: load-client [--unread] SOCKET CONNECTIONS LINES\n", stderr);
        return 2;
    }
    load.count = strtoul(argv[argc - 2], NULL, 10);
    if (load.count > CONNECTION_LIMIT) return 2;
    for (size_t i = 0; i < load.count; i++) {
        load.polls[i].fd = connect_to(argv[argc - 3]);
        if (load.polls[i].fd < 0) {
            perror(argv[argc - 3]);
            return 1;
        }
    }
    if (!run(&load, unread)) {
        perror("load-client");
        return 1;
    }
    if (unread) {
        puts("ready");
        fflush(stdout);
        pause();
    }
    for (size_t i = 0; i < load.count; i++)
        answers += load.connections[i].answers;
    printf("%zu answers, %zu errors\n", answers, load.errors);
    return 0;
}
