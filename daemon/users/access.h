// What a connection may ask for: as its peer, as nobody, or as the user of a token.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum access_kind {
    ACCESS_PEER,    // the user whom the kernel names, with all their rights
    ACCESS_DROPPED, // nobody: the connection gave its user up
    ACCESS_TOKEN    // the user of a token, within its scope
};

// What a token lets its holder do; each scope includes those before it.
enum access_scope {
    SCOPE_READ,   // look
    SCOPE_SUBMIT, // submit jobs and change those of its user, without an administrator's rights
    SCOPE_ADMIN,  // whatever its user may
    SCOPE_COUNT
};

extern const char *const access_scope_names[]; // end in NULL

// What a method needs of a connection.
enum access_need {
    NEED_UNSAID, // as NEED_PEER; of no method
    NEED_READ,   // a token of this scope, or a later one; or a peer
    NEED_SUBMIT,
    NEED_ADMIN,
    NEED_PEER,   // a user whom the kernel names: no token will do
    NEED_NOTICE, // the kernel names root, the daemon's own user or the web user
    NEED_NOTHING
};

enum { ACCESS_WRONG_LIMIT = 3 }; // wrong tokens on a connection, then it is closed

// The zero value is a peer's.
struct access {
    enum access_kind kind;
    enum access_scope scope; // of the token
    int64_t token;           // its id; 0: none
    int64_t expires_ms;      // unix time; 0: never
    int wrong_count;         // tokens that were tried in vain
};

// The scope that a token needs. False: no token will do.
bool access_find_scope(enum access_need need, enum access_scope *scope);
bool access_allows(const struct access *access, enum access_need need);
bool access_has_expired(const struct access *access, int64_t now_ms); // `now_ms` in unix time
