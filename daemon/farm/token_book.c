// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/token_book.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/store/store_reader.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { STORE_EVERY_MS = 60 * 1000, QUIET_MS = 1000 };

static bool find_scope(const char *name, enum access_scope *scope)
{
    for (int i = 0; i < SCOPE_COUNT; i++) {
        if (strcmp(access_scope_names[i], name) != 0) continue;
        *scope = (enum access_scope)i;
        return true;
    }
    return false;
}

static bool on_token(void *user, const struct store_token *row, struct error *error)
{
    struct farm *farm = user;
    struct token token = {.id = row->id,
                          .uid = row->owner_uid,
                          .created_ms = row->created_ms,
                          .expires_ms = row->expires_ms,
                          .used_ms = row->used_ms,
                          .is_once = row->is_once};

    if (!find_scope(row->scope, &token.scope) || strlen(row->hash) != TOKEN_HASH_SIZE - 1) {
        error_set(error, "store: token %" PRId64 " has scope \"%.20s\" and a hash of %zu digits, which is invalid",
                  row->id, row->scope, strlen(row->hash));
        return false;
    }
    memcpy(token.hash, row->hash, sizeof token.hash);
    token.name = xstrdup(row->name);
    token.user = xstrdup(row->owner);
    token_table_add(&farm->tokens, &token);
    return true;
}

bool token_book_restore(struct farm *farm, struct error *error)
{
    int64_t last_id;

    if (!store_read_tokens(farm->reader, on_token, farm, &last_id, error)) return false;
    if (last_id > farm->tokens.last_id) farm->tokens.last_id = last_id;
    return true;
}

struct store_op token_book_format_op(const struct token *token)
{
    return (struct store_op){.kind = STORE_SET_TOKEN,
                             .token = {.id = token->id,
                                       .hash = xstrdup(token->hash),
                                       .name = xstrdup(token->name),
                                       .owner = xstrdup(token->user),
                                       .owner_uid = token->uid,
                                       .scope = xstrdup(access_scope_names[token->scope]),
                                       .created_ms = token->created_ms,
                                       .expires_ms = token->expires_ms,
                                       .used_ms = token->used_ms,
                                       .is_once = token->is_once}};
}

void token_book_drop(struct farm *farm, struct token *token)
{
    farm_store(farm, (struct store_op){.kind = STORE_DELETE_TOKEN, .token = {.id = token->id}});
    token_table_remove(&farm->tokens, token);
}

void token_book_drop_expired(struct farm *farm)
{
    int64_t now_ms = farm_clock_ms();

    for (size_t i = farm->tokens.count; i-- > 0;) {
        struct token *token = farm->tokens.tokens[i];

        if (token_has_expired(token, now_ms) && !token->is_busy) token_book_drop(farm, token);
    }
}

void token_book_note_use(struct farm *farm, struct token *token)
{
    int64_t now_ms = farm_clock_ms();

    if (now_ms - token->used_ms < STORE_EVERY_MS && token->used_ms <= now_ms) return;
    token->used_ms = now_ms;
    farm_store(farm, token_book_format_op(token));
}

void token_book_tell_wrong(struct farm *farm, const char *user, const char *why)
{
    int64_t now_ms = farm_now_ms(farm);
    char more[64] = "";

    if (farm->wrong_tokens_told_ms > 0 && now_ms - farm->wrong_tokens_told_ms < QUIET_MS) {
        farm->wrong_tokens_untold++;
        return;
    }
    if (farm->wrong_tokens_untold > 0)
        snprintf(more, sizeof more, ", and %" PRId64 " more before", farm->wrong_tokens_untold);
    log_warn("token: %s tried one that does not hold: %s%s", user, why, more);
    farm->wrong_tokens_told_ms = now_ms;
    farm->wrong_tokens_untold = 0;
}
