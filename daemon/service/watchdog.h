// Tells the service manager that the loop turns, where it wants to be told (WatchdogSec= of systemd).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <uv.h>

struct watchdog;

// Feeds twice in the time that the manager waits, from a timer of `loop`: when a callback does not end or the process stops,
// so does the feeding. Each turn of a loop reads its sockets, too: one that spins is slow, and still serves. NULL where
// nobody waits.
struct watchdog *watchdog_open(uv_loop_t *loop);
// Frees itself when the loop has closed the timer; accepts NULL.
void watchdog_close(struct watchdog *watchdog);
