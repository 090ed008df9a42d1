// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/rights.h"

#include "core/base/alloc.h"
#include "core/base/log.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdlib.h>

enum { ENTRY_SIZE_LIMIT = 1024 * 1024 }; // bytes of a group entry with all its members

static int64_t find_group(const char *name)
{
    size_t size = 4096;
    char *text = NULL;
    struct group entry, *found = NULL;
    int result = ERANGE;

    while (result == ERANGE && size <= ENTRY_SIZE_LIMIT) {
        text = xrealloc(text, size);
        result = getgrnam_r(name, &entry, text, size, &found);
        size *= 4;
    }
    free(text);
    return result == 0 && found ? (int64_t)found->gr_gid : -1;
}

void rights_init(struct rights *rights, int64_t daemon_uid, const char *admin_group)
{
    rights->daemon_uid = daemon_uid;
    rights->admin_gid = admin_group ? find_group(admin_group) : -1;
    if (rights->admin_gid < 0 && admin_group) log_debug("the admin group \"%s\" does not exist", admin_group);
}

void rights_set_web_user(struct rights *rights, const char *name)
{
    struct passwd entry, *found = NULL;
    char text[4096];

    rights->has_web = name && *name && getpwnam_r(name, &entry, text, sizeof text, &found) == 0 && found;
    rights->web_uid = rights->has_web ? (int64_t)entry.pw_uid : -1;
}

bool rights_is_web_user(const struct rights *rights, const struct rights_peer *peer)
{
    return rights->has_web && rights_is_known(peer) && peer->uid == rights->web_uid;
}

bool rights_is_known(const struct rights_peer *peer)
{
    return peer->uid >= 0 && peer->uid != RIGHTS_OVERFLOW_UID;
}

bool rights_is_admin(const struct rights *rights, const struct rights_peer *peer)
{
    if (!rights_is_known(peer) || peer->is_ordinary) return false;
    if (peer->uid == 0 || peer->uid == rights->daemon_uid) return true;
    for (size_t i = 0; i < peer->group_count && rights->admin_gid >= 0; i++)
        if (peer->groups[i] == rights->admin_gid) return true;
    return false;
}

bool rights_may_change(const struct rights *rights, const struct rights_peer *peer, int64_t owner_uid)
{
    return rights_is_admin(rights, peer) || (rights_is_known(peer) && peer->uid == owner_uid);
}

gid_t *rights_find_groups(int64_t uid, const char *user, size_t *count)
{
    struct passwd entry, *found = NULL;
    char text[4096];
    int found_count = 64;
    gid_t *groups;

    *count = 0;
    // A uid that belongs to another name today is not that user.
    if (getpwnam_r(user, &entry, text, sizeof text, &found) != 0 || !found || (int64_t)found->pw_uid != uid)
        return NULL;
    groups = xcalloc((size_t)found_count, sizeof *groups);
    if (getgrouplist(user, found->pw_gid, groups, &found_count) < 0) {
        groups = xrealloc(groups, (size_t)found_count * sizeof *groups);
        if (getgrouplist(user, found->pw_gid, groups, &found_count) < 0) found_count = 0;
    }
    *count = (size_t)found_count;
    return groups;
}

bool rights_user_is_admin(const struct rights *rights, int64_t uid, const char *user)
{
    struct rights_peer peer = {.uid = uid};
    gid_t *groups = rights_find_groups(uid, user, &peer.group_count);
    bool is_admin;

    peer.groups = groups;
    is_admin = rights_is_admin(rights, &peer);
    free(groups);
    return is_admin;
}
