// A request that waits for its answer, and what the functions that answer requests share.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct gl_context;
struct job;
struct json_node;
struct json_writer;
struct renderer;

struct request {
    struct message message; // owned
    struct request *next;   // in the worker's list of requests
};

// Takes the message over.
struct request *request_create(struct message *message);
void request_destroy(struct request *request);
void request_destroy_all(struct request *first);

// The tools with which requests are answered; all borrowed.
struct request_tools {
    const char *shader_dir;           // NULL: the embedded modules
    const struct gl_context *context; // NULL with --backend none
    struct renderer *renderer;        // likewise
    bool (*is_wanted)(void *user); // may be NULL; false once nobody waits for the answer; long answers ask now and then
    // May be NULL; long answers tell how many parts are done, of how many, and how much of the next one, from 0 to 1.
    void (*on_part)(void *user, int64_t done, int64_t count, double share);
    void *user;
};

// Writes the result as one JSON value. On failure `code` is the JSON-RPC error to answer with.
typedef bool request_function(const struct json_node *params, const struct request_tools *tools,
                              struct json_writer *writer, enum message_code *code, struct error *error);

// Reads a request's job from its members `document` and `root` (absent: any). A draft has its settings chosen.
bool request_read_job(const struct json_node *params, struct job *job, struct error *error);
// False, with `error`, when there is no renderer.
bool request_check_renderer(const struct request_tools *tools, struct error *error);
// Opens a regular file for reading, -1 on failure: reading a pipe would block, and a folder has no bytes. `flags` are
// further ones of open(2).
int request_open_file(const char *path, int flags, struct error *error);
