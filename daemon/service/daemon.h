// Wires the daemon's modules to one loop, and takes them apart in order.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct daemon;
struct error;
struct options;

// Reads the settings anew, for SIGHUP.
typedef bool daemon_read_options(void *user, struct options *options, struct error *error);

// Opens the store, brings back what it holds and listens. `options` is lent until destroy, and changed by a reload. NULL on
// failure.
struct daemon *daemon_create(struct options *options, daemon_read_options *read_options, void *user,
                             struct error *error);
// Until SIGTERM or SIGINT: then running frames get their time, everything is committed, and it returns. SIGHUP reads the
// settings again; a daemon that was started in a terminal takes it as SIGTERM, for the terminal is gone.
void daemon_run(struct daemon *daemon);
void daemon_destroy(struct daemon *daemon); // after daemon_run; accepts NULL
