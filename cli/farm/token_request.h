// Asks the daemon for a new token of the user.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"
#include "core/wire/message.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct options;

struct token_request {
    const char *name, *scope;
    const char *expires; // "30d", or "never"; NULL: as the daemon has it
    bool is_once;
};

struct token_reply {
    struct message reply; // freed with message_finish
    int64_t id;
    const char *text; // borrowed from the reply
};

// On EXIT_STATUS_DONE the caller frees `token->reply`.
enum exit_status token_request_send(const struct options *options, const struct token_request *request,
                                    struct token_reply *token, struct error *error);
bool token_request_parse_id(const char *text, int64_t *id, struct error *error); // `error` may be NULL
