// The tokens of the farm as the store has them, and what the log says of wrong ones.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/store/store_op.h"

#include <stdbool.h>

struct client;
struct error;
struct farm;
struct token;

bool token_book_restore(struct farm *farm, struct error *error); // from the store, at the start
struct store_op token_book_format_op(const struct token *token); // STORE_SET_TOKEN
// Removes the token here and in the store, with tries until it is on disk.
void token_book_drop(struct farm *farm, struct token *token);
void token_book_drop_expired(struct farm *farm);
void token_book_note_use(struct farm *farm, struct token *token); // the store is told once a minute
// Logs that the user tried a token that does not hold, and why; of many at once, one line says how many.
void token_book_tell_wrong(struct farm *farm, const char *user, const char *why);
