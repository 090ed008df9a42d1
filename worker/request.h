// Questions that are answered rather than rendered: explain, preview, frames_png.
#pragma once

#include "core/message.h"

#include <stdbool.h>

struct connection;

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

// Does what is asked, however long it takes, and sends the result or an error.
void request_answer(const struct request *request, const char *shader_dir, struct connection *connection);
