// The real worker as a child, connected by a socket pair. Any failure fails the test.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message.h"
#include "core/wire/message_stream.h"

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

struct test_worker {
    pid_t pid;
    int fd;
    struct message_stream stream;
    char root[64]; // a folder of its own
};

void test_worker_start(struct test_worker *child, const char *backend, const char *device); // NULL: any
void test_worker_start_with(struct test_worker *child, const char *const options[]);        // a NULL ends them
// Starts one that renders in software and hears that it is ready; without such GL the test is skipped.
void test_worker_start_renderer(struct test_worker *child);
// Waits for the worker to end by itself and returns its exit status, -1 when it did not or a signal ended it. Its
// folder is removed.
int test_worker_finish(struct test_worker *child);

__attribute__((format(printf, 2, 3))) void test_worker_say(const struct test_worker *child, const char *format, ...);
bool test_worker_hear(struct test_worker *child, struct message *message); // false at the end of the stream
// The next message of this method; only heartbeats and states of frames may come before it.
struct message test_worker_expect(struct test_worker *child, const char *method);
void test_worker_expect_frame(struct test_worker *child, const char *method, int frame);
void test_worker_expect_failure(struct test_worker *child, int frame, const char *fault, const char *reason);
int64_t test_worker_integer_of(const struct message *message, const char *key);
const char *test_worker_text_of(const struct message *message, const char *key);
