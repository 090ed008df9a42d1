// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/client_peer.h"

#include "core/base/alloc.h"

#include <errno.h>
#include <pwd.h>
#include <sys/socket.h>

enum { FIRST_GROUPS = 64 }; // room for groups of a peer at first; there may be more

// Supplementary groups of the peer, then its primary group, which SO_PEERGROUPS leaves out.
static gid_t *read_groups(int fd, gid_t primary, size_t *count)
{
    socklen_t size = FIRST_GROUPS * sizeof(gid_t);
    gid_t *groups = NULL;
    int result = -1;

    for (int tries = 0; tries < 2 && result != 0; tries++) {
        groups = xrealloc(groups, size + sizeof(gid_t));
        result = getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, groups, &size);
        if (result != 0 && errno != ERANGE) break;
    }
    if (result != 0) size = 0;
    *count = size / sizeof(gid_t);
    groups[(*count)++] = primary;
    return groups;
}

gid_t *client_peer_read(int fd, struct rights_peer *peer, char **user)
{
    struct ucred found = {.uid = (uid_t)-1, .gid = (gid_t)-1};
    socklen_t length = sizeof found;
    struct passwd entry, *named = NULL;
    gid_t *groups = NULL;
    char text[4096];

    *peer = (struct rights_peer){.uid = -1};
    if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &found, &length) == 0 && found.uid != (uid_t)-1) {
        peer->uid = found.uid;
        groups = read_groups(fd, found.gid, &peer->group_count);
        peer->groups = groups;
    }
    if (peer->uid >= 0 && getpwuid_r(found.uid, &entry, text, sizeof text, &named) == 0 && named)
        *user = xstrdup(entry.pw_name);
    else
        *user = xasprintf("%lld", (long long)peer->uid);
    return groups;
}
