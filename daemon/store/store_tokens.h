// The rows of tokens. They are few and change seldom: no statement of theirs is kept.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/store/store_op.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct sqlite3;

bool store_tokens_set(struct sqlite3 *db, const struct store_token *token, struct error *error);
bool store_tokens_delete(struct sqlite3 *db, int64_t id, struct error *error);
// Called for each row, which is borrowed during the call. False stops the reading with the callback's error.
typedef bool store_on_token(void *user, const struct store_token *token, struct error *error);
// By id, those whose sums are right. `*last_id` is the highest id that was ever given.
bool store_tokens_read(struct sqlite3 *db, store_on_token *on_token, void *user, int64_t *last_id, struct error *error);
// Deletes all tokens of a copy that is about to become the store: some of them may have been revoked or used since.
bool store_tokens_forget(const char *path, struct error *error);
