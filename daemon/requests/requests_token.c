// Requests about tokens by those whose they are: create, list, revoke.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "core/base/utf8.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/clients/client_identity.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/token_book.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { ONCE_S = 5 * 60 };

// A token whose row is not on disk yet, or no longer.
struct pending_token {
    struct farm *farm;     // borrowed; outlives us
    struct answer *answer; // owned
    struct token *token;   // busy; NULL: it is revoked
    char text[TOKEN_TEXT_SIZE];
};

static bool read_name(struct request *request, char **name)
{
    struct json_node node = json_node_child(&request->params, "name");
    const char *text = "";

    if (!json_node_is_absent(&node) && !json_read_string(&node, &text, &request->error)) return false;
    if (strlen(text) > TOKEN_NAME_LIMIT || utf8_find_hidden(text))
        return json_fail(&node, &request->error, "expected at most %d printable bytes", TOKEN_NAME_LIMIT);
    *name = xstrdup(text);
    return true;
}

// A token for one use ends after five minutes at the latest, another one never unless that is asked for.
static bool read_expiry(struct request *request, struct token *token)
{
    struct json_node node = json_node_child(&request->params, "expires_s");
    int64_t seconds = token->is_once ? ONCE_S : 0;

    if (!json_node_is_absent(&node) && json_node_type(&node) != JSON_NULL &&
        !json_read_integer(&node, 1, token->is_once ? ONCE_S : TOKEN_LONGEST_S, &seconds, &request->error))
        return false;
    token->expires_ms = seconds > 0 ? token->created_ms + seconds * 1000 : 0;
    return true;
}

static bool read_token(struct request *request, struct token *token)
{
    struct json_node scope = json_node_child(&request->params, "scope");
    int choice;

    request->code = MESSAGE_CODE_PARAMS;
    token->created_ms = farm_clock_ms();
    if (!json_read_enum(&scope, access_scope_names, &choice, &request->error) ||
        !request_read_flag(request, "once", &token->is_once) || !read_expiry(request, token))
        return false;
    token->scope = (enum access_scope)choice;
    return read_name(request, &token->name);
}

// The user must be one who can be looked up again when the token is used.
static bool check_user(struct request *request)
{
    const struct client *client = request->client;
    size_t count;
    gid_t *groups;

    if (!rights_is_known(&client->peer)) {
        request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "the system does not say who you are (user %s)", client->user);
        return false;
    }
    groups = rights_find_groups(client->peer.uid, client->user, &count);
    free(groups);
    if (groups) return true;
    request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "uid %" PRId64 " has no name in the system's list of users",
                 client->peer.uid);
    return false;
}

static bool check_room(struct request *request)
{
    const struct token_table *tokens = &request->farm->tokens;
    bool is_user_full = token_table_count_user(tokens, request->client->peer.uid) >= TOKEN_USER_LIMIT;

    if (!is_user_full && tokens->count < TOKEN_TABLE_LIMIT) return true;
    if (is_user_full)
        request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "tokens: %.40s may have %d at a time: revoke one",
                     request->client->user, TOKEN_USER_LIMIT);
    else
        request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "tokens: a farm may have %d at a time", TOKEN_TABLE_LIMIT);
    return false;
}

static void on_created(void *user, bool ok, const struct error *error)
{
    struct pending_token *pending = user;
    struct token *token = pending->token;
    struct json_writer value = {0};

    if (ok) {
        token->is_busy = false;
        log_info("token %" PRId64 " of scope %s is made by %s", token->id, access_scope_names[token->scope],
                 token->user);
        json_write_begin_object(&value);
        json_write_integer_member(&value, "id", token->id);
        json_write_string_member(&value, "token", pending->text);
        json_write_end_object(&value);
        answer_send_result(pending->answer, &value);
        json_writer_finish(&value);
    } else {
        token_table_remove(&pending->farm->tokens, token);
        answer_send_error(pending->answer, MESSAGE_CODE_STORE, error->message);
    }
    explicit_bzero(pending->text, sizeof pending->text);
    free(pending);
}

enum request_outcome requests_token_create(struct request *request)
{
    struct farm *farm = request->farm;
    struct token token = {.uid = request->client->peer.uid, .is_busy = true};
    char text[TOKEN_TEXT_SIZE];
    struct pending_token *pending;
    struct store_op op;

    token_book_drop_expired(farm);
    if (!check_user(request) || !check_room(request) || !read_token(request, &token)) return REQUEST_FAILED;
    request->code = MESSAGE_CODE_INTERNAL;
    if (!token_text_make(text, &request->error)) {
        free(token.name);
        return REQUEST_FAILED;
    }
    token_text_hash(text, token.hash);
    token.user = xstrdup(request->client->user);
    pending = xcalloc(1, sizeof *pending);
    pending->farm = farm;
    pending->token = token_table_add(&farm->tokens, &token);
    pending->answer = request_defer_answer(request, false);
    memcpy(pending->text, text, sizeof pending->text);
    explicit_bzero(text, sizeof text);
    op = token_book_format_op(pending->token);
    committer_put(farm->committer, COMMIT_OR_DROP, &op, 1, on_created, pending);
    return REQUEST_DEFERRED;
}

static bool may_see(const struct request *request, const struct token *token)
{
    return rights_may_change(&request->farm->rights, &request->client->peer, token->uid);
}

static void write_time(struct json_writer *writer, const char *key, int64_t time_ms)
{
    if (time_ms > 0) {
        json_write_number_member(writer, key, (double)time_ms / 1000);
    } else {
        json_write_key(writer, key);
        json_write_null(writer);
    }
}

static void write_token(const struct token *token, struct json_writer *writer)
{
    json_write_begin_object(writer);
    json_write_integer_member(writer, "id", token->id);
    json_write_string_member(writer, "name", token->name);
    json_write_string_member(writer, "scope", access_scope_names[token->scope]);
    write_time(writer, "created", token->created_ms);
    write_time(writer, "expires", token->expires_ms);
    write_time(writer, "last_used", token->used_ms);
    json_write_bool_member(writer, "once", token->is_once);
    json_write_string_member(writer, "user", token->user);
    json_write_end_object(writer);
}

enum request_outcome requests_token_list(struct request *request)
{
    const struct token_table *tokens = &request->farm->tokens;

    token_book_drop_expired(request->farm);
    json_write_begin_object(request->result);
    json_write_key(request->result, "tokens");
    json_write_begin_array(request->result);
    for (size_t i = 0; i < tokens->count; i++)
        if (!tokens->tokens[i]->is_busy && may_see(request, tokens->tokens[i]))
            write_token(tokens->tokens[i], request->result);
    json_write_end_array(request->result);
    json_write_end_object(request->result);
    return REQUEST_ANSWERED;
}

static void on_revoked(void *user, bool ok, const struct error *error)
{
    struct pending_token *pending = user;
    struct json_writer value = {0};

    if (ok) {
        json_write_begin_object(&value);
        json_write_end_object(&value);
        answer_send_result(pending->answer, &value);
        json_writer_finish(&value);
    } else {
        answer_send_error(pending->answer, MESSAGE_CODE_STORE, error->message);
    }
    free(pending);
}

// It holds no longer, also where the store cannot commit that yet.
static void begin_revoke(struct request *request, struct token *token)
{
    struct farm *farm = request->farm;
    struct pending_token *pending = xcalloc(1, sizeof *pending);
    struct store_op op = {.kind = STORE_DELETE_TOKEN, .token = {.id = token->id}};

    log_info("token %" PRId64 " of %s is revoked by %s", token->id, token->user, request->client->user);
    client_identity_end_token(request->client, token->id, "token: it was revoked");
    token_table_remove(&farm->tokens, token);
    pending->farm = farm;
    pending->answer = request_defer_answer(request, false);
    committer_put(farm->committer, COMMIT_REPORTED, &op, 1, on_revoked, pending);
}

enum request_outcome requests_token_revoke(struct request *request)
{
    struct json_node node = json_node_child(&request->params, "id");
    struct token *token;
    int64_t id;

    request->code = MESSAGE_CODE_PARAMS;
    if (!json_read_integer(&node, 1, INT64_MAX, &id, &request->error)) return REQUEST_FAILED;
    token = token_table_find(&request->farm->tokens, id);
    if (!token) return request_fail(request, MESSAGE_CODE_NOT_FOUND, "token %" PRId64 ": there is no such token", id);
    if (!may_see(request, token))
        return request_fail(request, MESSAGE_CODE_NOT_ALLOWED,
                            "token %" PRId64 " belongs to %s: only they, root, the daemon's user and group %s may "
                            "revoke it, not %s",
                            id, token->user, request->farm->options->admin_group, request->client->user);
    if (token->is_busy)
        return request_fail(request, MESSAGE_CODE_CONFLICT, "token %" PRId64 " is being made or used: try again", id);
    begin_revoke(request, token);
    return REQUEST_DEFERRED;
}
