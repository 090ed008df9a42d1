// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/listener.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/clients/client_account.h"
#include "daemon/clients/client_identity.h"

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

enum {
    WAITING_LIMIT = 128,
    SOCKET_MODE = 0660,
    ACCEPT_LIMIT = 16,    // connections in one turn of the loop
    PAUSE_MS = 1000,      // after a connection that could not be accepted
    QUIET_MS = 60 * 1000, // between two lines of the log about that
    CHECK_MS = 5 * 1000   // between two looks at clients that do not read
};

struct listener {
    uv_poll_t poll;    // of the socket
    uv_timer_t resume; // active while no connection can be accepted
    uv_timer_t check;
    int fd; // owned
    struct listener_params params;
    struct client_host host;
    struct client_accounts accounts;
    struct client *clients;   // list of those connected
    char *path;               // owned; NULL: systemd's socket, which stays
    ino_t inode;              // of the socket at `path`
    uint64_t next_warning_ms; // of the loop's clock
    int open_handles;
    bool is_stopped, is_closing;
};

static void on_connection(uv_poll_t *poll, int status, int events);
static void on_resume(uv_timer_t *timer);
static void on_check(uv_timer_t *timer);
static void on_client_message(void *user, struct client *client, struct message *message);
static void on_client_closed(void *user, struct client *client);
static void on_handle_closed(uv_handle_t *handle);

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

static void init_handles(struct listener *listener, uv_loop_t *loop)
{
    uv_timer_init(loop, &listener->resume);
    uv_timer_init(loop, &listener->check);
    uv_poll_init(loop, &listener->poll, listener->fd);
    listener->poll.data = listener->resume.data = listener->check.data = listener;
    listener->open_handles = 3;
}

struct listener *listener_open(uv_loop_t *loop, const struct listener_params *params, struct error *error)
{
    struct listener *listener;
    ino_t inode = 0;
    bool is_inherited = sd_listen_fds(1) >= 1;
    int fd = is_inherited ? SD_LISTEN_FDS_START : make_socket(params->path, &inode, error);

    if (fd < 0) return NULL;
    raise_file_limit();
    listener = xcalloc(1, sizeof *listener);
    listener->params = *params;
    listener->fd = fd;
    listener->host = (struct client_host){.loop = loop,
                                          .turns = params->turns,
                                          .desk = params->desk,
                                          .memory = params->memory,
                                          .accounts = &listener->accounts,
                                          .on_message = on_client_message,
                                          .on_closed = on_client_closed,
                                          .user = listener};
    listener->path = is_inherited ? NULL : xstrdup(params->path);
    listener->inode = inode;
    init_handles(listener, loop);
    uv_timer_start(&listener->check, on_check, CHECK_MS, CHECK_MS);
    if (uv_poll_start(&listener->poll, UV_READABLE, on_connection) != 0) {
        error_set(error, "socket %s: cannot listen", is_inherited ? "from systemd" : params->path);
        listener_close(listener);
        return NULL;
    }
    return listener;
}

// No user may take all descriptors. Root and the daemon's own user are exempt: they could kill the daemon anyway.
static bool is_over_limit(const struct client *client, size_t limit)
{
    int64_t uid = client->peer.uid;

    return uid != 0 && uid != geteuid() && client->outgoing.account->client_count > limit;
}

static void add_client(struct listener *listener, struct client *client)
{
    bool is_web = rights_is_web_user(listener->params.rights, &client->peer);
    size_t limit = is_web ? CLIENT_ACCOUNT_WEB_CLIENTS : CLIENT_ACCOUNT_CLIENTS;
    char why[128];

    client->next = listener->clients;
    if (client->next) client->next->previous = client;
    listener->clients = client;
    client->outgoing.account = client_accounts_join(&listener->accounts, client->peer.uid);
    if (!is_over_limit(client, limit)) {
        client_start(client);
        return;
    }
    snprintf(why, sizeof why, "connections: %.40s may have %zu at a time", client->user, limit);
    client_refuse(client, MESSAGE_CODE_NOT_ALLOWED, why);
}

// Connections stay in the socket's queue until there are descriptors again. That is tried every second, and said once a
// minute.
static void pause_accepting(struct listener *listener, int errnum)
{
    struct error error = {0};
    uint64_t now_ms = uv_now(listener->host.loop);

    uv_poll_stop(&listener->poll);
    uv_timer_start(&listener->resume, on_resume, PAUSE_MS, 0);
    if (now_ms < listener->next_warning_ms) return;
    listener->next_warning_ms = now_ms + QUIET_MS;
    error_set_errno(&error, errnum, "socket: connections have to wait, tried again every second");
    log_warn("%s", error.message);
}

static void on_connection(uv_poll_t *poll, int status, int events)
{
    struct listener *listener = poll->data;

    for (int count = 0; count < ACCEPT_LIMIT; count++) {
        int fd = accept4(listener->fd, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);
        struct client *client = fd >= 0 ? client_create(&listener->host, fd) : NULL;

        if (client) add_client(listener, client);
        if (fd >= 0 || errno == EINTR || errno == ECONNABORTED) continue;
        if (errno != EAGAIN) pause_accepting(listener, errno);
        return;
    }
}

static void on_client_message(void *user, struct client *client, struct message *message)
{
    struct listener *listener = user;

    listener->params.on_message(listener->params.user, client, message);
}

static void on_resume(uv_timer_t *timer)
{
    struct listener *listener = timer->data;

    uv_poll_start(&listener->poll, UV_READABLE, on_connection);
}

static void on_check(uv_timer_t *timer)
{
    struct listener *listener = timer->data;
    int64_t now_ms = (int64_t)(clock_read_s(CLOCK_REALTIME) * 1000);

    for (struct client *client = listener->clients; client; client = client->next) {
        client_identity_check(client, now_ms);
        client_check_stuck(client);
    }
}

static void free_if_done(struct listener *listener)
{
    if (listener->open_handles > 0 || !listener->is_closing || listener->clients) return;
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
    listener->params.on_gone(listener->params.user, client);
    client_accounts_leave(&listener->accounts, client->outgoing.account);
    free_if_done(listener);
}

void listener_stop(struct listener *listener)
{
    struct stat status;

    if (listener->is_stopped) return;
    listener->is_stopped = true;
    if (listener->path && lstat(listener->path, &status) == 0 && status.st_ino == listener->inode)
        unlink(listener->path);
    uv_close((uv_handle_t *)&listener->poll, on_handle_closed);
    uv_close((uv_handle_t *)&listener->resume, on_handle_closed);
    uv_close((uv_handle_t *)&listener->check, on_handle_closed);
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

static void on_handle_closed(uv_handle_t *handle)
{
    struct listener *listener = handle->data;

    if (--listener->open_handles == 0) close(listener->fd);
    free_if_done(listener);
}
