// What the service manager is told of the daemon: ready, reloading, stopping, and a line on how it goes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct farm;
struct manager;

// The line is told every few seconds, where it changed. Nothing is told where nobody listens (NOTIFY_SOCKET).
struct manager *manager_open(struct farm *farm); // borrowed; outlives us
void manager_close(struct manager *manager);     // frees itself when the loop has closed its timer

void manager_notify_ready(struct manager *manager); // also after a reload
void manager_notify_reloading(const struct manager *manager);
// From now on the line says that it stops. The manager is asked to wait for as long as frames may take, and then for what
// is left to be written down.
void manager_notify_stopping(struct manager *manager, int64_t timeout_ms);
