// One request while it is handled, and what several methods need to read it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/wire/message.h"

#include <stdbool.h>
#include <stdint.h>

struct answer;
struct client;
struct farm;
struct job_record;
struct json_writer;

enum request_outcome {
    REQUEST_ANSWERED, // the result is written
    REQUEST_FAILED,   // code and error are filled
    REQUEST_DEFERRED  // the answer comes later, by request_defer_answer
};

// One request while it is handled; lives on the stack.
struct request {
    struct farm *farm;
    struct client *client;
    struct message *message;    // whose root a method may take
    const char *id;             // as JSON text; empty: the client wants no answer
    struct json_node params;    // may be absent
    struct json_writer *result; // for one JSON value
    enum message_code code;
    struct error error;
};

// Fills code and error; returns REQUEST_FAILED.
enum request_outcome request_fail(struct request *request, enum message_code code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// Reads params.id; NULL: REQUEST_FAILED, with code and error filled.
struct job_record *request_find_job(struct request *request);
bool request_may_change(const struct request *request, const struct job_record *record);
// Whether the client may give a job that priority; false with code and error filled.
bool request_may_have_priority(struct request *request, int64_t priority);
// As request_find_job; a job that the client may not change is a failure.
struct job_record *request_find_own_job(struct request *request);
// Reads a set of names, one string or an array of them, as bits 1 << index. Absent: `fallback`.
bool request_read_set(struct request *request, const char *key, const char *const names[], unsigned fallback,
                      unsigned *set);

// Read a parameter; absent: `*flag` is not changed. False with code and error filled.
bool request_read_flag(struct request *request, const char *key, bool *flag);
bool request_read_count(struct request *request, const char *key, int64_t min, int64_t max, int64_t fallback,
                        int64_t *count); // absent: `fallback`
// The text of a range, which is not looked at yet; borrowed from the message. NULL: absent.
bool request_read_range(struct request *request, const char **text);

// The answer is sent later. `is_long` as in answer_create.
struct answer *request_defer_answer(const struct request *request, bool is_long);
