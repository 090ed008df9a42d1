// Who may change which job: its owner, root, the daemon's own user, members of the admin group.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct error;

// Whoever is at the other end of a connection, as the kernel says it.
struct rights_peer {
    int64_t uid;         // -1: unknown
    const gid_t *groups; // borrowed; its primary group among them
    size_t group_count;
};

struct rights {
    int64_t daemon_uid;
    int64_t admin_gid; // -1: there is no such group
};

// The user that stands for all whom a user namespace has no number for: nobody in particular.
enum { RIGHTS_OVERFLOW_UID = 65534 };

// Looks the group up; legal again at any time, as at a reload. A group that does not exist is nobody's.
void rights_init(struct rights *rights, int64_t daemon_uid, const char *admin_group);
// Root, the daemon's own user, members of the admin group: they may change every job, and have no limits.
bool rights_is_admin(const struct rights *rights, const struct rights_peer *peer);
bool rights_may_change(const struct rights *rights, const struct rights_peer *peer, int64_t owner_uid);
// Somebody who can own a job.
bool rights_is_known(const struct rights_peer *peer);
// What rights_is_admin would say of that user, who is not here. Asks the user database, which may take its time.
bool rights_user_is_admin(const struct rights *rights, int64_t uid, const char *user);
