// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/methods.h"
#include "daemon/requests/requests.h"
#include "daemon/users/token_table.h"

#include <stddef.h>

static const struct member auth_params[] = {
    {"token", "string", .meaning = "the text of a token"},
    {0},
};
static const struct member auth_result[] = {
    {"user", "string", .meaning = "whose requests the connection's are from here on"},
    {"uid", "integer", .meaning = "the same as a number"},
    {"scope", "string", .meaning = "what they may be", .names = access_scope_names},
    {"expires", "number?", .meaning = "unix seconds; null: never"},
    {"session", "string?", .meaning = "after a token for one use: another one, in place of it"},
    {0},
};

static const struct member create_params[] = {
    {"scope", "string", .meaning = "what it is for: to look; to submit, too; or all that its user may",
     .names = access_scope_names},
    {"name", "string", .meaning = "what its user calls it, at most 64 bytes", .fallback = "\"\"", .is_optional = true},
    {"expires_s", "integer?", .meaning = "seconds that it holds; null: for ever, or five minutes if it is for one use",
     .min = 1, .max = TOKEN_LONGEST_S, .fallback = "null", .is_optional = true},
    {"once", "boolean", .meaning = "it is for one use", .fallback = "false", .is_optional = true},
    {0},
};
static const struct member create_result[] = {
    {"id", "integer", .meaning = "its number", .min = 1},
    {"token", "string", .meaning = "its text, which nobody can ask for again"},
    {0},
};

static const struct member list_result[] = {
    {"tokens", "token[]", .meaning = "of the user; of all users, for administrators"},
    {0},
};

static const struct member revoke_params[] = {
    {"id", "integer", .meaning = "the token", .min = 1},
    {0},
};

const struct method methods_of_tokens[] = {
    {"auth.token", requests_auth_token, "Gives the connection the identity of a token.", NEED_NOTHING,
     .params = auth_params, .result = auth_result},
    {"auth.drop", requests_auth_drop, "Gives up the identity of the peer: only auth.token is answered then.",
     .need = NEED_NOTHING},
    {"token.create", requests_token_create, "Makes a token of the user.", NEED_PEER, .params = create_params,
     .result = create_result},
    {"token.list", requests_token_list, "All tokens of the user, without their texts.", NEED_PEER,
     .result = list_result},
    {"token.revoke", requests_token_revoke, "Ends a token, and the connections that use it.", NEED_PEER,
     .params = revoke_params},
    {0},
};
