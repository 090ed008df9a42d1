// Whom a client is taken for: its peer as the kernel names it, nobody, or the user of a token.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/users/access.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct client;

// The user of a token.
struct client_identity {
    int64_t uid;
    const char *user; // borrowed
    gid_t *groups;    // moved in
    size_t group_count;
    struct access access;
};

// The client is nobody from here on; its messages count as its peer's, whom the log still names.
void client_identity_drop(struct client *client);
// Whether the user may have one connection more.
bool client_identity_has_room(const struct client *client, int64_t uid);
// The client is that user from here on, and its connection counts as theirs. No answer of it may be due but the one
// that tells. It does nothing while the client is closing, but frees the groups.
void client_identity_take(struct client *client, const struct client_identity *identity);
// Closes each client of a token, of all that are connected where `client` is.
void client_identity_end_token(struct client *client, int64_t token, const char *why);
// To be called every few seconds: closes a client whose token has expired. `now_ms` in unix time.
void client_identity_check(struct client *client, int64_t now_ms);
