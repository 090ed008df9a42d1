// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/listener.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

enum { WAITING_LIMIT = 128, SOCKET_MODE = 0660, CONNECTIONS_LIMIT = 64 }; // of one user

struct listener {
    uv_pipe_t pipe;
    struct listener_handlers handlers;
    struct client_handlers client_handlers;
    struct client *clients; // list of those connected
    char *path;             // owned; NULL: systemd's socket, which stays
    ino_t inode;            // of the socket at `path`
    bool is_stopped, is_closing;
    bool is_pipe_closed;
};

static void on_connection(uv_stream_t *server, int status);
static void on_client_message(void *user, struct client *client, const struct message *message);
static void on_client_closed(void *user, struct client *client);
static void on_pipe_closed(uv_handle_t *handle);

static bool fill_address(struct sockaddr_un *address, const char *path, const char *suffix, struct error *error)
{
    size_t limit = sizeof address->sun_path - 1;

    *address = (struct sockaddr_un){.sun_family = AF_UNIX};
    if (strlen(path) + strlen(suffix) > limit) {
        error_set(error, "socket %s: expected a path of at most %zu bytes, got %zu", path, limit - strlen(suffix),
                  strlen(path));
        return false;
    }
    memcpy(address->sun_path, path, strlen(path));
    memcpy(address->sun_path + strlen(path), suffix, strlen(suffix) + 1);
    return true;
}

static bool check_nobody_answers(const char *path, struct error *error)
{
    struct sockaddr_un address;
    struct stat status;
    bool answers;
    int fd;

    if (!fill_address(&address, path, "", error)) return false;
    if (lstat(path, &status) != 0) return true;
    if (!S_ISSOCK(status.st_mode)) {
        error_set(error, "socket %s: the path exists and is not a socket", path);
        return false;
    }
    fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    answers = fd >= 0 && connect(fd, (struct sockaddr *)&address, sizeof address) == 0;
    if (fd >= 0) close(fd);
    if (answers) error_set(error, "socket %s: another daemon answers there", path);
    return !answers;
}

// The folder of the socket, which a service manager would have made.
static void make_parent(const char *path)
{
    char *folder = xstrdup(path);
    char *slash = strrchr(folder, '/');

    if (slash && slash != folder) {
        *slash = '\0';
        mkdir(folder, 0755);
    }
    free(folder);
}

// The socket is bound beside its name and renamed: nobody sees it with the wrong mode, and a stale one is replaced
// atomically.
static int make_socket(const char *path, ino_t *inode, struct error *error)
{
    struct sockaddr_un address;
    struct stat status;
    int fd = -1;

    if (!check_nobody_answers(path, error)) return -1;
    if (!fill_address(&address, path, ".new", error)) return -1;
    make_parent(path);
    unlink(address.sun_path);
    fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0) goto fail;
    if (bind(fd, (struct sockaddr *)&address, sizeof address) != 0) goto fail;
    if (chmod(address.sun_path, SOCKET_MODE) != 0 || listen(fd, WAITING_LIMIT) != 0) goto fail;
    if (lstat(address.sun_path, &status) != 0 || rename(address.sun_path, path) != 0) goto fail;
    *inode = status.st_ino;
    return fd;
fail:
    error_set_errno(error, errno, "socket %s", path);
    unlink(address.sun_path);
    if (fd >= 0) close(fd);
    return -1;
}

// The hard limit of descriptors becomes the soft one, which is low only for programs that use select().
static void raise_file_limit(void)
{
    struct rlimit limit;

    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
}

struct listener *listener_open(uv_loop_t *loop, const char *path, const struct listener_handlers *handlers,
                               struct error *error)
{
    struct listener *listener;
    ino_t inode = 0;
    bool is_inherited = sd_listen_fds(1) >= 1;
    int fd = is_inherited ? SD_LISTEN_FDS_START : make_socket(path, &inode, error);

    if (fd < 0) return NULL;
    raise_file_limit();
    listener = xcalloc(1, sizeof *listener);
    listener->handlers = *handlers;
    listener->client_handlers =
        (struct client_handlers){.on_message = on_client_message, .on_closed = on_client_closed, .user = listener};
    listener->path = is_inherited ? NULL : xstrdup(path);
    listener->inode = inode;
    uv_pipe_init(loop, &listener->pipe, 0);
    listener->pipe.data = listener;
    if (uv_pipe_open(&listener->pipe, fd) != 0 ||
        uv_listen((uv_stream_t *)&listener->pipe, WAITING_LIMIT, on_connection) != 0) {
        error_set(error, "socket %s: cannot listen", is_inherited ? "from systemd" : path);
        listener_close(listener);
        return NULL;
    }
    return listener;
}

// No user may take all descriptors. Root and the daemon's own user are exempt: they could kill the daemon anyway.
static void check_connection_limit(const struct listener *listener, struct client *client)
{
    int64_t uid = client->peer.uid;
    size_t count = 0;
    char why[128];

    if (uid == 0 || uid == geteuid()) return;
    for (const struct client *other = listener->clients; other; other = other->next)
        if (other->peer.uid == uid) count++;
    if (count <= CONNECTIONS_LIMIT) return;
    snprintf(why, sizeof why, "connections: %.40s may have %d at a time", client->user, CONNECTIONS_LIMIT);
    client_refuse(client, MESSAGE_CODE_NOT_ALLOWED, why);
}

static void on_connection(uv_stream_t *server, int status)
{
    struct listener *listener = server->data;
    struct client *client;

    if (status != 0) {
        log_warn("socket: %s", uv_strerror(status));
        return;
    }
    client = client_accept(server, &listener->client_handlers);
    if (!client) return;
    client->next = listener->clients;
    if (client->next) client->next->previous = client;
    listener->clients = client;
    check_connection_limit(listener, client);
}

static void on_client_message(void *user, struct client *client, const struct message *message)
{
    struct listener *listener = user;

    listener->handlers.on_message(listener->handlers.user, client, message);
}

static void free_if_done(struct listener *listener)
{
    if (!listener->is_pipe_closed || !listener->is_closing || listener->clients) return;
    free(listener->path);
    free(listener);
}

static void on_client_closed(void *user, struct client *client)
{
    struct listener *listener = user;

    if (client->previous)
        client->previous->next = client->next;
    else
        listener->clients = client->next;
    if (client->next) client->next->previous = client->previous;
    listener->handlers.on_gone(listener->handlers.user, client);
    free_if_done(listener);
}

void listener_stop(struct listener *listener)
{
    struct stat status;

    if (listener->is_stopped) return;
    listener->is_stopped = true;
    if (listener->path && lstat(listener->path, &status) == 0 && status.st_ino == listener->inode)
        unlink(listener->path);
    uv_close((uv_handle_t *)&listener->pipe, on_pipe_closed);
}

void listener_stop_reading(struct listener *listener)
{
    for (struct client *client = listener->clients; client; client = client->next)
        client_stop_reading(client);
}

void listener_close(struct listener *listener)
{
    listener->is_closing = true;
    for (struct client *client = listener->clients; client; client = client->next)
        client_close(client);
    listener_stop(listener);
    free_if_done(listener);
}

static void on_pipe_closed(uv_handle_t *handle)
{
    struct listener *listener = handle->data;

    listener->is_pipe_closed = true;
    free_if_done(listener);
}
