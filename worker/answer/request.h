// Questions that are answered rather than rendered: explain, preview, frames_png, verify.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message.h"

#include <stdbool.h>

struct connection;
struct error;
struct gl_context;
struct job;
struct json_node;
struct json_writer;
struct renderer;

struct request {
    struct message message; // owned
    struct request *next;   // on the worker's list of requests
};

// True for a method that request_answer knows.
bool request_is_known(const char *method);
// Takes the message over; it must be of a known method.
struct request *request_create(struct message *message);
void request_destroy(struct request *request);
void request_destroy_all(struct request *first);

// What answers are made with; all of it is borrowed.
struct request_tools {
    const char *shader_dir;           // NULL: the embedded modules
    const struct gl_context *context; // NULL with --backend none
    struct renderer *renderer;        // likewise
    bool (*is_wanted)(void *user);    // false once nobody waits for the answer: what takes long asks now and then
    void *user;
};

// Writes the result as one JSON value. On failure `code` says which JSON-RPC error to answer with.
typedef bool request_function(const struct json_node *params, const struct request_tools *tools,
                              struct json_writer *writer, enum message_code *code, struct error *error);

// Does what is asked, however long it takes, and sends the result or an error.
void request_answer(const struct request *request, const struct request_tools *tools, struct connection *connection);

// Reads the job that a request is about, from its members `document` and `root` (absent: any).
bool request_read_job(const struct json_node *params, struct job *job, struct error *error);
