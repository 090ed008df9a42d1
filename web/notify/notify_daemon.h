// Asks the daemon for notices, and tells it which are over; blocking, for the thread that delivers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct notify_daemon;
struct notify_queue;
struct notify_targets;

// Both are borrowed. A call ends early when `stop_fd` can be read.
struct notify_daemon *notify_daemon_create(const char *socket_path, int stop_fd);
void notify_daemon_destroy(struct notify_daemon *daemon); // accepts NULL

// Adds what is new to the queue; `*is_all` (may be NULL): nothing more waits. On a new connection the daemon is told
// whom jobs may name.
bool notify_daemon_ask(struct notify_daemon *daemon, const struct notify_targets *targets, bool allows_webhooks,
                       struct notify_queue *queue, bool *is_all, struct error *error);
// `why`: why it is given up; NULL: it is delivered.
bool notify_daemon_tell(struct notify_daemon *daemon, int64_t id, const char *why, struct error *error);
