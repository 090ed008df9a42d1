// Wires the daemon's modules to one loop, and takes them apart in order.
#pragma once

struct daemon;
struct error;
struct options;

// Opens the store, brings back what it holds and listens. `options` is lent until destroy. NULL on failure.
struct daemon *daemon_create(const struct options *options, struct error *error);
// Until SIGTERM or SIGINT: then running frames get their time, everything is committed, and it returns.
void daemon_run(struct daemon *daemon);
void daemon_destroy(struct daemon *daemon); // after daemon_run; accepts NULL
