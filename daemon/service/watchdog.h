// Feeds the watchdog of the service manager from the loop (WatchdogSec= of systemd).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <uv.h>

struct watchdog;

// Feeds the watchdog twice per interval, from a timer of `loop`: feeding ends when a callback does not return or the
// process stops. A loop that is busy in every iteration still feeds: it is slow, but reads its sockets. NULL when there
// is no watchdog.
struct watchdog *watchdog_open(uv_loop_t *loop);
// Frees itself when the loop has closed the timer; accepts NULL.
void watchdog_close(struct watchdog *watchdog);
