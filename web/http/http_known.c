// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_known.h"

#include "core/base/alloc.h"
#include "core/base/hash.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

enum { ENTRY_LIMIT = 1024 };

struct entry {
    uint64_t hash;
    uint64_t turn; // when it was asked for last
    char *user;    // owned
};

struct http_known {
    uint64_t secret, turn;
    size_t count;
    struct entry entries[ENTRY_LIMIT];
};

struct http_known *http_known_create(void)
{
    struct http_known *known = xcalloc(1, sizeof *known);

    if (getrandom(&known->secret, sizeof known->secret, 0) < 0) abort();
    return known;
}

void http_known_destroy(struct http_known *known)
{
    if (!known) return;
    for (size_t i = 0; i < known->count; i++)
        free(known->entries[i].user);
    free(known);
}

static struct entry *find(struct http_known *known, const char *token)
{
    uint64_t hash = hash_bytes_short(token, strlen(token), known->secret);

    for (size_t i = 0; i < known->count; i++)
        if (known->entries[i].hash == hash) return &known->entries[i];
    return NULL;
}

static struct entry *make_entry(struct http_known *known)
{
    struct entry *oldest = &known->entries[0];

    if (known->count < ENTRY_LIMIT) return &known->entries[known->count++];
    for (size_t i = 1; i < known->count; i++)
        if (known->entries[i].turn < oldest->turn) oldest = &known->entries[i];
    return oldest;
}

void http_known_add(struct http_known *known, const char *token, const char *user)
{
    struct entry *entry = find(known, token);

    if (entry && strcmp(entry->user, user) == 0) return;
    if (!entry) entry = make_entry(known);
    free(entry->user);
    *entry = (struct entry){
        .hash = hash_bytes_short(token, strlen(token), known->secret), .turn = ++known->turn, .user = xstrdup(user)};
}

void http_known_drop(struct http_known *known, const char *token)
{
    struct entry *entry = find(known, token);

    if (!entry) return;
    free(entry->user);
    *entry = known->entries[--known->count];
    known->entries[known->count] = (struct entry){0};
}

const char *http_known_user(struct http_known *known, const char *token)
{
    struct entry *entry = token ? find(known, token) : NULL;

    if (!entry) return NULL;
    entry->turn = ++known->turn;
    return entry->user;
}
