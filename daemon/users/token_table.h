// The tokens of a farm: whose they are, what they are for, and which one a hash belongs to. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/users/access.h"
#include "daemon/users/token_text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TOKEN_USER_LIMIT = 100, TOKEN_TABLE_LIMIT = 10000, TOKEN_NAME_LIMIT = 64 };
enum { TOKEN_LONGEST_S = 10 * 366 * 24 * 3600 }; // of a token that ends

struct token {
    int64_t id;
    char hash[TOKEN_HASH_SIZE];
    char *name; // owned; what its user calls it
    char *user; // owned; whose it is, by name and number
    int64_t uid;
    enum access_scope scope;
    int64_t created_ms, expires_ms, used_ms; // unix time; 0: never
    bool is_once;                            // its first use ends it
    bool is_busy;                            // a change of it is not on disk yet: nobody can use or change it
};

// Tokens by ascending id. The zero value is empty.
struct token_table {
    struct token **tokens; // owned; each lives until it is removed
    size_t count, capacity;
    int64_t last_id; // that was ever given
};

// Moves the token in, with the next id if it has none.
struct token *token_table_add(struct token_table *table, const struct token *token);
void token_table_remove(struct token_table *table, struct token *token); // frees it
void token_table_finish(struct token_table *table);

struct token *token_table_find(const struct token_table *table, int64_t id); // NULL: there is none
// The token of that hash, NULL: there is none. The time depends on the number of tokens alone.
struct token *token_table_match(const struct token_table *table, const char hash[static TOKEN_HASH_SIZE]);
size_t token_table_count_user(const struct token_table *table, int64_t uid);
bool token_has_expired(const struct token *token, int64_t now_ms);
