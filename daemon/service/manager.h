// Notifies the service manager: ready, reloading, stopping, and a status line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct farm;
struct manager;

// The status line is sent every 2 s, when it changed. Nothing is sent when NOTIFY_SOCKET is not set.
struct manager *manager_open(struct farm *farm); // borrowed; outlives us
void manager_close(struct manager *manager);     // frees itself when the loop has closed its timer

void manager_notify_ready(struct manager *manager); // also after a reload
void manager_notify_reloading(const struct manager *manager);
// The status line says from now on that the daemon stops. The service manager is asked to wait for the frames
// (`timeout_ms`) and 20 s more for commits.
void manager_notify_stopping(struct manager *manager, int64_t timeout_ms);
