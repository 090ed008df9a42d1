// Delivers the daemon's notices, in a thread of its own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct notifier;
struct notify_targets;

// Borrowed; outlive the notifier.
struct notifier_params {
    const char *socket_path; // the daemon's
    const struct notify_targets *targets;
    bool allows_webhooks; // jobs may name addresses
    int64_t timeout_ms;   // of one attempt
    int64_t keep_ms;      // so long after it was made a notice is given up
};

// Each secret can be read, and each command is there.
bool notifier_check(const struct notify_targets *targets, struct error *error);
// To be called before other threads are started. NULL on failure.
struct notifier *notifier_start(const struct notifier_params *params, struct error *error);
void notifier_stop(struct notifier *notifier); // waits for the thread, which drops what is under way; accepts NULL
