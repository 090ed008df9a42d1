// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/farm.h"

#include "core/base/alloc.h"
#include "daemon/store/committer.h"

#include <time.h>

int64_t farm_now_ms(const struct farm *farm)
{
    return (int64_t)uv_now(farm->loop);
}

int64_t farm_clock_ms(void)
{
    struct timespec now;

    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

void farm_want_feed(struct farm *farm)
{
    farm->wants_feed = true;
}

char *farm_format_drain(const struct farm *farm)
{
    if (!farm->drain.user) return NULL;
    return xasprintf("drained by %s: no frame is begun until `march undrain` or a restart", farm->drain.user);
}

void farm_store(struct farm *farm, struct store_op op)
{
    committer_put(farm->committer, COMMIT_SILENT, &op, 1, NULL, NULL);
}

void farm_store_job(struct farm *farm, const struct job_record *record)
{
    farm_store(farm, job_record_format_op(record));
}
