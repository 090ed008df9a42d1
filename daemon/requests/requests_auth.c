// Requests by which a connection takes the identity of a token, or gives up its own.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/clients/client_identity.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/token_book.h"
#include "daemon/jobs/events.h"
#include "daemon/store/committer.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SESSION_MS = 12 * 3600 * 1000 }; // of a browser

// What is still being answered was asked for with the rights that the connection had.
static bool check_idle(struct request *request)
{
    if (request->client->pending_answers == 0) return true;
    request_fail(request, MESSAGE_CODE_CONFLICT, "expected no other request of the connection to be unanswered");
    return false;
}

enum request_outcome requests_auth_drop(struct request *request)
{
    if (request->client->access.kind == ACCESS_TOKEN)
        return request_fail(request, MESSAGE_CODE_CONFLICT, "auth.drop: the connection has a token's identity already");
    if (!check_idle(request)) return REQUEST_FAILED;
    events_forget(request->farm->events, request->client);
    client_identity_drop(request->client);
    json_write_begin_object(request->result);
    json_write_end_object(request->result);
    return REQUEST_ANSWERED;
}

// What a connection gets for a token.
struct sign_in {
    struct farm *farm;     // borrowed; outlives us
    struct client *client; // held by the answer, or handling its request
    struct client_identity identity;
    struct answer *answer;        // owned; NULL: at once
    struct token *used, *session; // of a token for one use: it, and what comes in its place; busy
    char text[TOKEN_TEXT_SIZE];   // of the session
};

static void write_seconds(struct json_writer *writer, const char *key, int64_t time_ms)
{
    if (time_ms > 0) {
        json_write_number_member(writer, key, (double)time_ms / 1000);
    } else {
        json_write_key(writer, key);
        json_write_null(writer);
    }
}

static void write_identity(const struct client_identity *identity, const char *session, struct json_writer *writer)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "user", identity->user);
    json_write_integer_member(writer, "uid", identity->uid);
    json_write_string_member(writer, "scope", access_scope_names[identity->access.scope]);
    write_seconds(writer, "expires", identity->access.expires_ms);
    json_write_string_member(writer, "session", session);
    json_write_end_object(writer);
}

static void take_identity(struct farm *farm, struct client *client, struct client_identity *identity,
                          const struct token *token)
{
    identity->access = (struct access){
        .kind = ACCESS_TOKEN, .scope = token->scope, .token = token->id, .expires_ms = token->expires_ms};
    events_forget(farm->events, client);
    client_identity_take(client, identity);
    identity->groups = NULL;
}

static void on_used(void *user, bool ok, const struct error *error)
{
    struct sign_in *sign_in = user;
    struct token_table *tokens = &sign_in->farm->tokens;
    struct json_writer value = {0};

    if (ok) {
        sign_in->session->is_busy = false;
        sign_in->identity.user = sign_in->session->user;
        token_table_remove(tokens, sign_in->used);
        take_identity(sign_in->farm, sign_in->client, &sign_in->identity, sign_in->session);
        write_identity(&sign_in->identity, sign_in->text, &value);
        answer_send_result(sign_in->answer, &value);
        json_writer_finish(&value);
    } else {
        sign_in->used->is_busy = false;
        token_table_remove(tokens, sign_in->session);
        answer_send_error(sign_in->answer, MESSAGE_CODE_STORE, error->message);
    }
    free(sign_in->identity.groups);
    explicit_bzero(sign_in->text, sizeof sign_in->text);
    free(sign_in);
}

// The token is used up, and a session takes its place, in one transaction.
static enum request_outcome use_up(struct request *request, struct token *token, struct client_identity *identity)
{
    struct farm *farm = request->farm;
    struct sign_in *sign_in = xcalloc(1, sizeof *sign_in);
    int64_t now_ms = farm_clock_ms();
    struct token session = {.uid = token->uid,
                            .scope = token->scope,
                            .created_ms = now_ms,
                            .used_ms = now_ms,
                            .expires_ms = now_ms + SESSION_MS,
                            .is_busy = true};
    struct store_op ops[2];

    request->code = MESSAGE_CODE_INTERNAL;
    if (!token_text_make(sign_in->text, &request->error)) {
        free(identity->groups);
        free(sign_in);
        return REQUEST_FAILED;
    }
    token_text_hash(sign_in->text, session.hash);
    session.name = xstrdup(token->name);
    session.user = xstrdup(token->user);
    token->is_busy = true;
    sign_in->farm = farm;
    sign_in->client = request->client;
    sign_in->identity = *identity;
    sign_in->used = token;
    sign_in->session = token_table_add(&farm->tokens, &session);
    sign_in->answer = request_defer_answer(request, true);
    ops[0] = token_book_format_op(sign_in->session);
    ops[1] = (struct store_op){.kind = STORE_DELETE_TOKEN, .token = {.id = token->id}};
    committer_put(farm->committer, COMMIT_OR_DROP, ops, 2, on_used, sign_in);
    return REQUEST_DEFERRED;
}

// Who asks is told the same whatever is wrong; the log knows more.
static enum request_outcome refuse(struct request *request, const char *why)
{
    request->client->access.wrong_count++;
    token_book_tell_wrong(request->farm, request->client->user, why);
    return request_fail(request, MESSAGE_CODE_NOT_ALLOWED,
                        "token: it is wrong, has expired or was revoked, or its user is gone");
}

static struct token *find_token(struct request *request, char *why, size_t why_size)
{
    struct json_node node = json_node_child(&request->params, "token");
    char hash[TOKEN_HASH_SIZE];
    const char *text;
    struct token *token;

    request->code = MESSAGE_CODE_PARAMS;
    if (!json_read_string(&node, &text, &request->error)) return NULL;
    token_text_hash(text, hash);
    token = token_table_match(&request->farm->tokens, hash);
    if (!token) {
        snprintf(why, why_size, "there is no such token");
    } else if (token->is_busy) {
        snprintf(why, why_size, "token %" PRId64 " is used already", token->id);
        token = NULL;
    } else if (token_has_expired(token, farm_clock_ms())) {
        snprintf(why, why_size, "token %" PRId64 " of %s has expired", token->id, token->user);
        token = NULL;
    }
    return token;
}

enum request_outcome requests_auth_token(struct request *request)
{
    struct client *client = request->client;
    struct client_identity identity = {0};
    char why[128] = "";
    struct token *token;

    if (client->access.kind == ACCESS_TOKEN)
        return request_fail(request, MESSAGE_CODE_CONFLICT,
                            "auth.token: the connection has a token's identity already");
    if (!check_idle(request)) return REQUEST_FAILED;
    token = find_token(request, why, sizeof why);
    if (!token) return why[0] ? refuse(request, why) : REQUEST_FAILED;
    identity = (struct client_identity){.uid = token->uid, .user = token->user};
    identity.groups = rights_find_groups(token->uid, token->user, &identity.group_count);
    if (!identity.groups) {
        snprintf(why, sizeof why, "token %" PRId64 " is of %s, uid %" PRId64 ", who is gone", token->id, token->user,
                 token->uid);
        return refuse(request, why);
    }
    if (!client_identity_has_room(client, token->uid)) {
        free(identity.groups);
        return request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "connections: %.40s may have %d at a time", token->user,
                            CLIENT_ACCOUNT_CLIENTS);
    }
    if (token->is_once) return use_up(request, token, &identity);
    take_identity(request->farm, client, &identity, token);
    token_book_note_use(request->farm, token);
    write_identity(&identity, NULL, request->result);
    return REQUEST_ANSWERED;
}
