// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/daemon_socket.h"

#include "cli/peer/connection.h"
#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

enum { ORDINARY_USERS = 1000 }; // ids of users below are the system's, as that of the package

// Returns the connected socket, or -1 with errno set.
static int connect_to(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd;

    if (strlen(path) >= sizeof address.sun_path) {
        errno = ENAMETOOLONG;
        return -1;
    }
    memcpy(address.sun_path, path, strlen(path) + 1);
    fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0) return -1;
    if (connect(fd, (struct sockaddr *)&address, sizeof address) != 0) {
        int reason = errno;

        close(fd);
        errno = reason;
        return -1;
    }
    return fd;
}

static bool is_refused(int reason)
{
    return reason == EACCES || reason == EPERM;
}

// Whether the socket is of the private daemon of root or of an ordinary user: its group is theirs, and to be joined by
// nobody else.
static bool is_private(const struct stat *status, const struct passwd *owner)
{
    if (status->st_uid > 0 && status->st_uid < ORDINARY_USERS) return false;
    return status->st_gid == owner->pw_gid || !(status->st_mode & S_IWGRP);
}

// Says which group may connect and how to join it; empty when the socket has no such group. Owned by the caller.
static char *describe_group(const char *path)
{
    struct stat status;
    const struct passwd *user;
    const struct group *group;

    if (stat(path, &status) != 0) return xstrdup("");
    user = getpwuid(status.st_uid);
    if (user && is_private(&status, user))
        return xasprintf(": its daemon is one of %s's own, for %s alone", user->pw_name, user->pw_name);
    group = getgrgid(status.st_gid);
    if (!group || !(status.st_mode & S_IWGRP)) return xstrdup("");
    user = getpwuid(geteuid());
    return xasprintf(": only group %s may connect (root adds you with `usermod -aG %s %s`; then log in again)",
                     group->gr_name, group->gr_name, user ? user->pw_name : "YOU");
}

// "A (why) or B (why)" for sockets that failed otherwise than by permission; NULL when there is none.
static char *list_silent(char *const paths[], const int reasons[], size_t count)
{
    char *list = NULL;

    for (size_t i = 0; i < count; i++) {
        char *longer;

        if (is_refused(reasons[i])) continue;
        longer = xasprintf("%s%s%s (%s)", list ? list : "", list ? " or " : "", paths[i], strerrordesc_np(reasons[i]));
        free(list);
        list = longer;
    }
    return list;
}

static enum exit_status fail(char *const paths[], const int reasons[], size_t count, struct error *error)
{
    char *silent = list_silent(paths, reasons, count), *group;

    for (size_t i = 0; i < count; i++) {
        if (!is_refused(reasons[i])) continue;
        group = describe_group(paths[i]);
        error_set(error, "the socket %s is not for you%s%s%s", paths[i], group,
                  silent ? "; nor does a daemon of your own answer at " : "", silent ? silent : "");
        free(group);
        free(silent);
        return EXIT_STATUS_NOT_ALLOWED;
    }
    error_set(error,
              "no daemon answers at %s; start one with `systemctl start marchd`, or one of your own with `marchd`, and "
              "name its socket with --socket or $MARCHD_SOCKET if it is elsewhere",
              silent ? silent : "any socket");
    free(silent);
    return EXIT_STATUS_NO_DAEMON;
}

struct connection *daemon_socket_connect(char *const paths[], size_t count, enum exit_status *status,
                                         struct error *error)
{
    int *reasons = xcalloc(count + 1, sizeof *reasons);
    struct connection *connection = NULL;

    for (size_t i = 0; i < count && !connection; i++) {
        int fd = connect_to(paths[i]);

        if (fd < 0)
            reasons[i] = errno;
        else
            connection = connection_adopt(fd, "the daemon");
    }
    if (!connection) *status = fail(paths, reasons, count, error);
    free(reasons);
    return connection;
}
