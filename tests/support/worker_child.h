// The real worker as a child, connected by a socket pair. Any failure fails the test.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message.h"
#include "core/wire/message_stream.h"

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

struct worker_child {
    pid_t pid;
    int fd;
    struct message_stream stream;
    char root[64]; // a folder of its own
};

void worker_child_start(struct worker_child *child, const char *backend, const char *device); // NULL: any
void worker_child_start_with(struct worker_child *child, const char *const options[]);        // a NULL ends them
// Starts one with OSMesa and hears that it is ready; without OSMesa the test is skipped.
void worker_child_start_renderer(struct worker_child *child);
// Waits for the worker to end by itself and returns its exit status, -1 when it did not or a signal ended it. Its
// folder is removed.
int worker_child_finish(struct worker_child *child);

__attribute__((format(printf, 2, 3))) void worker_child_say(const struct worker_child *child, const char *format, ...);
bool worker_child_hear(struct worker_child *child, struct message *message); // false at the end of the stream
// The next message of this method; only heartbeats and states of frames may come before it.
struct message worker_child_expect(struct worker_child *child, const char *method);
void worker_child_expect_frame(struct worker_child *child, const char *method, int frame);
void worker_child_expect_failure(struct worker_child *child, int frame, const char *fault, const char *reason);
int64_t worker_child_integer_of(const struct message *message, const char *key);
const char *worker_child_text_of(const struct message *message, const char *key);
