// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/token_request.h"
#include "cli/peer/connection.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "cli/terminal/table.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static enum exit_status fail_usage(struct error *error, const char *what)
{
    error_set(error, "%s, see `march help token`", what);
    return EXIT_STATUS_USAGE;
}

static enum exit_status create(const struct options *options, struct error *error)
{
    const struct token_request request = {.name = options->operand_count > 1 ? options->operands[1] : "",
                                          .scope = options->scope ? options->scope : "read",
                                          .expires = options->expires ? options->expires : "90d"};
    struct token_reply token;
    enum exit_status status;

    if (options->operand_count > 2) return fail_usage(error, "create: expected one name at most");
    status = token_request_send(options, &request, &token, error);
    if (status != EXIT_STATUS_DONE) return status;
    if (options->json) {
        print_json(&token.reply.body);
    } else {
        fprintf(stderr, "token %" PRId64 " of scope %s: keep it, it is shown only now\n", token.id, request.scope);
        printf("%s\n", token.text);
    }
    message_finish(&token.reply);
    return status;
}

static void add_time(struct table *table, const struct json_node *token, const char *key)
{
    struct json_node node = json_node_child(token, key);
    char text[PRINT_TIME_SIZE];
    double time = -1;

    if (json_node_type(&node) == JSON_NUMBER) json_read_number(&node, 0, 1e12, &time, NULL);
    print_format_time(time, text);
    table_add(table, text);
}

static void add_text(struct table *table, const struct json_node *token, const char *key)
{
    struct json_node node = json_node_child(token, key);
    const char *text;

    table_add(table, json_read_string(&node, &text, NULL) && *text ? text : NULL);
}

static void print_tokens(const struct json_node *tokens)
{
    static const struct table_column columns[] = {{"ID", true},       {"NAME", false},    {"SCOPE", false},
                                                  {"USER", false},    {"CREATED", false}, {"EXPIRES", false},
                                                  {"LAST USE", false}};
    struct table table = {.columns = columns, .column_count = sizeof columns / sizeof *columns};
    struct json_node token = {0};

    while (json_node_next(tokens, &token)) {
        struct json_node node = json_node_child(&token, "id");
        int64_t id = 0;

        json_read_integer(&node, 1, INT64_MAX, &id, NULL);
        table_add_format(&table, "%" PRId64, id);
        add_text(&table, &token, "name");
        add_text(&table, &token, "scope");
        add_text(&table, &token, "user");
        add_time(&table, &token, "created");
        add_time(&table, &token, "expires");
        add_time(&table, &token, "last_used");
    }
    print_table(&table);
    table_finish(&table);
}

static enum exit_status list(const struct options *options, struct error *error)
{
    struct message reply;
    struct json_node tokens;
    enum exit_status status;

    if (options->operand_count > 1) return fail_usage(error, "list: expected nothing after it");
    status = daemon_call(options, "token.list", NULL, &reply, error);
    if (status != EXIT_STATUS_DONE) return status;
    tokens = json_node_child(&reply.body, "tokens");
    if (options->json)
        print_json(&reply.body);
    else
        print_tokens(&tokens);
    message_finish(&reply);
    return status;
}

// Goes on when one fails.
static enum exit_status revoke_one(const struct options *options, int64_t id, struct json_writer *revoked,
                                   struct json_writer *errors)
{
    struct message reply;
    struct error error = {0};
    char params[64];
    enum exit_status status;

    snprintf(params, sizeof params, "{\"id\":%" PRId64 "}", id);
    status = daemon_call(options, "token.revoke", params, &reply, &error);
    if (status == EXIT_STATUS_DONE) {
        json_write_integer(revoked, id);
        if (!options->json) printf("token %" PRId64 ": revoked\n", id);
        message_finish(&reply);
        return status;
    }
    if (!options->json) fprintf(stderr, "march token: %s\n", error.message);
    json_write_begin_object(errors);
    json_write_integer_member(errors, "id", id);
    json_write_string_member(errors, "error", error.message);
    json_write_end_object(errors);
    return status;
}

static enum exit_status revoke_all(const struct options *options, struct error *error)
{
    struct json_writer revoked = {0}, errors = {0}, result = {0};
    enum exit_status status = EXIT_STATUS_DONE;
    int64_t id;

    if (options->operand_count < 2) return fail_usage(error, "revoke: expected the number of a token");
    for (size_t i = 1; i < options->operand_count; i++) {
        if (token_request_parse_id(options->operands[i], &id, error)) continue;
        return EXIT_STATUS_USAGE;
    }
    json_write_begin_array(&revoked);
    json_write_begin_array(&errors);
    for (size_t i = 1; i < options->operand_count; i++) {
        enum exit_status one;

        token_request_parse_id(options->operands[i], &id, NULL);
        one = revoke_one(options, id, &revoked, &errors);
        if (status == EXIT_STATUS_DONE) status = one;
    }
    json_write_end_array(&revoked);
    json_write_end_array(&errors);
    if (options->json) {
        json_write_begin_object(&result);
        json_write_key(&result, "revoked");
        json_write_raw(&result, revoked.text, revoked.length);
        json_write_key(&result, "errors");
        json_write_raw(&result, errors.text, errors.length);
        json_write_end_object(&result);
        print_json_text(&result);
    }
    json_writer_finish(&revoked);
    json_writer_finish(&errors);
    json_writer_finish(&result);
    return status;
}

enum exit_status command_token(const struct options *options, struct error *error)
{
    const char *what = options->operands[0];

    if (strcmp(what, "create") == 0) return create(options, error);
    if (strcmp(what, "list") == 0) return list(options, error);
    if (strcmp(what, "revoke") == 0) return revoke_all(options, error);
    error_set(error, "expected create, list or revoke, got \"%s\"", what);
    return EXIT_STATUS_USAGE;
}
