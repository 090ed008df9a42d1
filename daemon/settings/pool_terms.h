// On which terms a pool is used: the tags that jobs may ask for it by, and who may use it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct error;

struct pool_user {
    char *name;  // owned; a user's name, their uid in digits, or "@" and a group's name
    int64_t gid; // of a group; -1: it is none, or there is no such group
};

// The zero value: no tags, and everybody may use the pool.
struct pool_terms {
    char **tags; // owned, and owned
    size_t tag_count;
    struct pool_user *users; // owned
    size_t user_count;       // 0: everybody
};

// Reads "a,b", or "anna,@light", and adds it. Groups are looked up now.
bool pool_terms_read_tags(struct pool_terms *terms, const char *value, struct error *error);
bool pool_terms_read_users(struct pool_terms *terms, const char *value, struct error *error);
void pool_terms_finish(struct pool_terms *terms); // accepts the zero value
bool pool_terms_have_tag(const struct pool_terms *terms, const char *tag);
bool pool_terms_let(const struct pool_terms *terms, int64_t uid, const char *name, const gid_t *groups, size_t count);
bool pool_terms_are_same(const struct pool_terms *a, const struct pool_terms *b);
char *pool_terms_format_users(const struct pool_terms *terms); // "anna, @light"; owned by the caller
