// A JSON-RPC 2.0 message, as clients, the daemon and workers exchange them: one a line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct json_writer;

enum { MESSAGE_ID_SIZE = 64 };

enum message_kind {
    MESSAGE_REQUEST,      // method, params, id
    MESSAGE_NOTIFICATION, // method, params
    MESSAGE_RESULT,       // result, id
    MESSAGE_ERROR         // error code, text and id
};

// The codes of JSON-RPC 2.0, then our own.
enum message_code {
    MESSAGE_CODE_PARSE = -32700,
    MESSAGE_CODE_INVALID = -32600,
    MESSAGE_CODE_NO_METHOD = -32601,
    MESSAGE_CODE_PARAMS = -32602,
    MESSAGE_CODE_INTERNAL = -32603,
    MESSAGE_CODE_NOT_FOUND = 1,
    MESSAGE_CODE_NOT_ALLOWED = 2,
    MESSAGE_CODE_CONFLICT = 3, // the state does not allow it, or another job owns the output
    MESSAGE_CODE_STORE = 4     // the store cannot commit
};

struct message {
    enum message_kind kind;
    char id[MESSAGE_ID_SIZE]; // as JSON text (`7`, `"a"`, `null`); empty for a notification
    const char *method;       // borrowed from root
    struct json_node body;    // params or result; may be absent. Its path starts at "params" or "result".
    int code;                 // MESSAGE_ERROR only
    const char *text;         // MESSAGE_ERROR only; borrowed from root
    struct cJSON *root;       // owned
};

// On failure `*code` says which JSON-RPC error to answer with, and `message->id` holds the id if one could be read.
bool message_decode(struct message *message, const char *line, size_t length, enum message_code *code,
                    struct error *error);
void message_finish(struct message *message);
// Takes the root, which the caller then owns, out of the message: nothing else of it may be used any more but its id.
struct cJSON *message_take_root(struct message *message);

// After a begin, the caller writes params (or the result) as one JSON value; message_end then closes the line, newline
// included. A writer may hold several messages.
void message_begin_request(struct json_writer *writer, int64_t id, const char *method);
void message_begin_notification(struct json_writer *writer, const char *method);
void message_begin_result(struct json_writer *writer, const char *id);
void message_end(struct json_writer *writer);
void message_write_error(struct json_writer *writer, const char *id, enum message_code code, const char *text);
