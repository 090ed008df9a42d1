// A worker process for one question: its start, its limits, its one answer and its end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message_stream.h"
#include "web/pictures/picture_status.h"

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct error;

struct picture_child_params {
    const char *program;
    int64_t memory_bytes; // that it may allocate
    int64_t file_bytes;   // that a file may have which it writes
    int limit_ms;
    const atomic_bool *is_stopped; // ends the wait; NULL: nothing does
};

// The zero value is empty.
struct picture_child {
    struct message_stream stream; // owned
    const char *line;             // of the answer, in the stream
    size_t length;
    pid_t left;      // it was killed and has not ended yet: a disk holds it; 0: it has ended
    int64_t ends_ms; // it is not waited for longer, on the monotonic clock
};

// Starts the worker without GL, fenced and of low priority, sends it these messages, and waits for the answer to its
// request. The process has ended when it returns, or was killed and is `left`: it writes no more. PICTURE_READY: there
// is an answer, an error perhaps.
enum picture_status picture_child_ask(struct picture_child *child, const struct picture_child_params *params,
                                      const char *words, size_t count, struct error *error);
const char *picture_child_answer(const struct picture_child *child, size_t *length);
void picture_child_finish(struct picture_child *child);
