// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/token_table.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// The index of the first token whose id is not less.
static size_t find_index(const struct token_table *table, int64_t id)
{
    size_t low = 0, high = table->count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;

        if (table->tokens[middle]->id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

struct token *token_table_add(struct token_table *table, const struct token *token)
{
    struct token *added = xmalloc(sizeof *added);
    size_t index;

    *added = *token;
    if (added->id == 0) added->id = table->last_id + 1;
    if (added->id > table->last_id) table->last_id = added->id;
    index = find_index(table, added->id);
    table->tokens = xgrow(table->tokens, &table->capacity, table->count + 1, sizeof(struct token *));
    memmove(&table->tokens[index + 1], &table->tokens[index], (table->count - index) * sizeof(struct token *));
    table->tokens[index] = added;
    table->count++;
    return added;
}

static void free_token(struct token *token)
{
    free(token->name);
    free(token->user);
    free(token);
}

void token_table_remove(struct token_table *table, struct token *token)
{
    size_t index = find_index(table, token->id);

    assert(index < table->count && table->tokens[index] == token);
    table->count--;
    memmove(&table->tokens[index], &table->tokens[index + 1], (table->count - index) * sizeof(struct token *));
    free_token(token);
}

void token_table_finish(struct token_table *table)
{
    for (size_t i = 0; i < table->count; i++)
        free_token(table->tokens[i]);
    free(table->tokens);
    *table = (struct token_table){0};
}

struct token *token_table_find(const struct token_table *table, int64_t id)
{
    size_t index = find_index(table, id);

    return index < table->count && table->tokens[index]->id == id ? table->tokens[index] : NULL;
}

struct token *token_table_match(const struct token_table *table, const char hash[static TOKEN_HASH_SIZE])
{
    struct token *found = NULL;

    for (size_t i = 0; i < table->count; i++)
        if (token_text_is_same(table->tokens[i]->hash, hash)) found = table->tokens[i];
    return found;
}

size_t token_table_count_user(const struct token_table *table, int64_t uid)
{
    size_t count = 0;

    for (size_t i = 0; i < table->count; i++)
        count += table->tokens[i]->uid == uid;
    return count;
}

bool token_has_expired(const struct token *token, int64_t now_ms)
{
    return token->expires_ms > 0 && now_ms >= token->expires_ms;
}
