// Who may change which job: its owner, root, the daemon's own user, members of the admin group.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct error;

// The user at the other end of a connection, from the kernel.
struct rights_peer {
    int64_t uid;         // -1: unknown
    const gid_t *groups; // borrowed; with the primary group
    size_t group_count;
    bool is_ordinary; // never an administrator, whoever it is: a token says so
};

struct rights {
    int64_t daemon_uid;
    int64_t admin_gid; // -1: the group does not exist
    bool has_web;      // there is a web user:
    int64_t web_uid;   // of the program that gives the farm to browsers
};

// The uid that stands for every user whom a user namespace does not map.
enum { RIGHTS_OVERFLOW_UID = 65534 };

// Looks up the group; may be called again, as at a reload. A group that does not exist has no members.
void rights_init(struct rights *rights, int64_t daemon_uid, const char *admin_group);
// Looks up the web user; may be called again. NULL, an empty name, or that of no user: there is none.
void rights_set_web_user(struct rights *rights, const char *name);
bool rights_is_web_user(const struct rights *rights, const struct rights_peer *peer);
// Administrators may change every job and have no limits: root, the daemon's own user, members of the admin group.
bool rights_is_admin(const struct rights *rights, const struct rights_peer *peer);
bool rights_may_change(const struct rights *rights, const struct rights_peer *peer, int64_t owner_uid);
// Whether the peer is a user who can own a job.
bool rights_is_known(const struct rights_peer *peer);
// The groups of a user without a connection, with the primary one; owned by the caller, NULL: there is no such user.
// Reads the user database, which may block.
gid_t *rights_find_groups(int64_t uid, const char *user, size_t *count);
// As rights_is_admin, for a user without a connection. Reads the user database, which may block.
bool rights_user_is_admin(const struct rights *rights, int64_t uid, const char *user);
