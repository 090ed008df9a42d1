// Connects the daemon's modules to one loop, and ends them in order.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct daemon;
struct error;
struct options;

// Reads the settings again, after SIGHUP.
typedef bool daemon_read_options(void *user, struct options *options, struct error *error);

// Opens the store, restores its jobs and listens. `options` is borrowed until daemon_destroy and changed by a reload.
// NULL on failure.
struct daemon *daemon_create(struct options *options, daemon_read_options *read_options, void *user,
                             struct error *error);
// Returns after SIGTERM or SIGINT, when running frames had their time and everything is committed. SIGHUP reads the
// settings again; in a daemon that was started in a terminal it acts as SIGTERM, for the terminal is gone.
void daemon_run(struct daemon *daemon);
void daemon_destroy(struct daemon *daemon); // after daemon_run; accepts NULL
