// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_listener.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "web/http/http_peer.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { BACKLOG = 128, TURN_LIMIT = 32, REST_MS = 100 };

struct http_listener {
    struct http_listener_params params;
    uv_poll_t poll;
    uv_timer_t rest; // after a shortage of descriptors
    int fd, port;
    int open_handles;
};

static void on_readable(uv_poll_t *poll, int status, int events);
static void on_rested(uv_timer_t *timer);
static void on_handle_closed(uv_handle_t *handle);

static bool read_port(const char *text, in_port_t *port)
{
    size_t digits = strspn(text, "0123456789");
    long number = strtol(text, NULL, 10);

    *port = htons((in_port_t)number);
    return digits > 0 && digits <= 5 && !text[digits] && number <= 65535;
}

static bool read_address(const char *text, struct sockaddr_storage *storage, socklen_t *size)
{
    struct sockaddr_in *v4 = (struct sockaddr_in *)storage;
    struct sockaddr_in6 *v6 = (struct sockaddr_in6 *)storage;
    const char *colon = strrchr(text, ':');
    char host[INET6_ADDRSTRLEN + 2];
    size_t length = colon ? (size_t)(colon - text) : 0;

    *storage = (struct sockaddr_storage){0};
    if (length == 0 || length >= sizeof host) return false;
    memcpy(host, text, length);
    host[length] = '\0';
    if (host[0] == '[' && host[length - 1] == ']') {
        host[length - 1] = '\0';
        v6->sin6_family = AF_INET6;
        *size = sizeof *v6;
        return inet_pton(AF_INET6, host + 1, &v6->sin6_addr) == 1 && read_port(colon + 1, &v6->sin6_port);
    }
    v4->sin_family = AF_INET;
    *size = sizeof *v4;
    return inet_pton(AF_INET, host, &v4->sin_addr) == 1 && read_port(colon + 1, &v4->sin_port);
}

bool http_address_check(const char *address, struct error *error)
{
    struct sockaddr_storage storage;
    socklen_t size;

    if (read_address(address, &storage, &size)) return true;
    error_set(error, "--listen: expected ADDRESS:PORT like 127.0.0.1:8470 or [::1]:8470, got \"%s\"", address);
    return false;
}

bool http_address_is_loopback(const char *address)
{
    struct sockaddr_storage storage;
    socklen_t size;

    if (!read_address(address, &storage, &size)) return false;
    if (storage.ss_family == AF_INET6) return IN6_IS_ADDR_LOOPBACK(&((struct sockaddr_in6 *)&storage)->sin6_addr);
    return ntohl(((struct sockaddr_in *)&storage)->sin_addr.s_addr) >> 24 == 127;
}

static int listen_at(const char *address, int *port)
{
    struct sockaddr_storage storage;
    socklen_t size;
    int yes = 1, fd, failure;

    if (!read_address(address, &storage, &size)) {
        errno = EINVAL;
        return -1;
    }
    fd = socket(storage.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0) return -1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (bind(fd, (struct sockaddr *)&storage, size) == 0 && listen(fd, BACKLOG) == 0 &&
        getsockname(fd, (struct sockaddr *)&storage, &size) == 0) {
        *port = ntohs(storage.ss_family == AF_INET6 ? ((struct sockaddr_in6 *)&storage)->sin6_port
                                                    : ((struct sockaddr_in *)&storage)->sin_port);
        return fd;
    }
    failure = errno;
    close(fd);
    errno = failure;
    return -1;
}

struct http_listener *http_listener_open(const struct http_listener_params *params, struct error *error)
{
    int port, fd = listen_at(params->address, &port);
    struct http_listener *listener;

    if (fd < 0) {
        error_set_errno(error, errno, "%s", params->address);
        return NULL;
    }
    listener = xcalloc(1, sizeof *listener);
    listener->params = *params;
    listener->params.address = NULL;
    listener->fd = fd;
    listener->port = port;
    uv_poll_init(params->loop, &listener->poll, fd);
    uv_timer_init(params->loop, &listener->rest);
    listener->open_handles = 2;
    listener->poll.data = listener->rest.data = listener;
    uv_poll_start(&listener->poll, UV_READABLE, on_readable);
    return listener;
}

int http_listener_port(const struct http_listener *listener)
{
    return listener->port;
}

// False: there are none, or none can be taken now.
static bool take_connection(struct http_listener *listener)
{
    struct sockaddr_storage storage = {0};
    socklen_t size = sizeof storage;
    struct http_peer peer;
    int yes = 1, fd = accept4(listener->fd, (struct sockaddr *)&storage, &size, SOCK_CLOEXEC | SOCK_NONBLOCK);

    if (fd < 0 && error_is_shortage(errno)) {
        log_warn("a connection waits: %s", strerror(errno));
        uv_poll_stop(&listener->poll);
        uv_timer_start(&listener->rest, on_rested, REST_MS, 0);
    }
    if (fd < 0) return errno == ECONNABORTED || errno == EINTR;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    peer = http_peer_name((const struct sockaddr *)&storage);
    listener->params.on_connection(listener->params.user, fd, &peer);
    return true;
}

static void on_readable(uv_poll_t *poll, int status, int events)
{
    (void)events;
    if (status < 0) return;
    for (int i = 0; i < TURN_LIMIT && take_connection(poll->data); i++)
        ;
}

static void on_rested(uv_timer_t *timer)
{
    struct http_listener *listener = timer->data;

    uv_poll_start(&listener->poll, UV_READABLE, on_readable);
}

static void on_handle_closed(uv_handle_t *handle)
{
    struct http_listener *listener = handle->data;

    if (--listener->open_handles > 0) return;
    close(listener->fd);
    free(listener);
}

void http_listener_close(struct http_listener *listener)
{
    if (!listener) return;
    uv_close((uv_handle_t *)&listener->poll, on_handle_closed);
    uv_close((uv_handle_t *)&listener->rest, on_handle_closed);
}
