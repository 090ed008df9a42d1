// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/drain.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/events.h"
#include "daemon/jobs/feed.h"

#include <stdlib.h>

void drain_begin(struct farm *farm, const char *user)
{
    if (farm->drain.user) return;
    farm->drain = (struct farm_drain){.user = xstrdup(user), .since_ms = farm_clock_ms()};
    log_info("drained by %s: %lld frames run and are finished, none is begun", user,
             (long long)queue_count(farm->queue, FRAME_RUNNING));
    feed_recall_all(farm);
    events_note_reasons(farm->events);
}

void drain_end(struct farm *farm, const char *user)
{
    if (!farm->drain.user) return;
    free(farm->drain.user);
    farm->drain = (struct farm_drain){0};
    log_info("undrained by %s: frames are begun again", user);
    farm_want_feed(farm);
    events_note_reasons(farm->events);
}
