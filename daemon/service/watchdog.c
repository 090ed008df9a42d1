// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/watchdog.h"

#include "core/base/alloc.h"

#include <stdint.h>
#include <stdlib.h>
#include <systemd/sd-daemon.h>

struct watchdog {
    uv_timer_t timer;
};

static void on_time(uv_timer_t *timer)
{
    (void)timer;
    sd_notify(0, "WATCHDOG=1");
}

struct watchdog *watchdog_open(uv_loop_t *loop)
{
    struct watchdog *watchdog;
    uint64_t limit_us = 0, feed_ms;

    if (sd_watchdog_enabled(0, &limit_us) <= 0) return NULL;
    feed_ms = limit_us / 2000 > 0 ? limit_us / 2000 : 1;
    watchdog = xcalloc(1, sizeof *watchdog);
    watchdog->timer.data = watchdog;
    uv_timer_init(loop, &watchdog->timer);
    uv_timer_start(&watchdog->timer, on_time, feed_ms, feed_ms);
    return watchdog;
}

static void on_closed(uv_handle_t *handle)
{
    free(handle->data);
}

void watchdog_close(struct watchdog *watchdog)
{
    if (watchdog) uv_close((uv_handle_t *)&watchdog->timer, on_closed);
}
