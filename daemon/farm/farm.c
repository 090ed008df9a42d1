// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/farm.h"

#include "core/base/log.h"
#include "daemon/farm/limits.h"
#include "daemon/jobs/events.h"
#include "daemon/jobs/job_change.h"
#include "daemon/jobs/job_delete.h"
#include "daemon/output/sweeper.h"
#include "daemon/store/committer.h"
#include "daemon/workers/worker_pool.h"

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

void farm_store_job(struct farm *farm, const struct job_record *record)
{
    struct store_op op = job_record_format_op(record);

    committer_put(farm->committer, COMMIT_SILENT, &op, 1, NULL, NULL);
}

// Its end is written down only after its leftovers are gone, so that a restart removes what a crash left.
static void wind_up(struct farm *farm, struct job_record *record)
{
    struct log_subject subject = job_record_subject(record);

    record->is_ending = true;
    record->is_sweeping = true;
    log_about(LOG_INFO, &subject, "job %lld (\"%s\"): %s", (long long)record->id, record->name,
              job_state_name(queue_job_state(record->queued)));
    worker_pool_forget_job(farm->pool, record->id);
    sweeper_sweep_job(farm->sweeper, record);
}

void farm_on_swept(void *user, struct job_record *record)
{
    struct farm *farm = user;

    record->is_sweeping = false;
    record->is_settled = record->is_ending;
    farm_store_job(farm, record);
    job_change_retry_waiting(farm, record);
    job_delete_go_on(farm);
}

void farm_note_change(struct farm *farm, struct job_record *record)
{
    bool is_live = queue_job_is_live(record->queued);

    limits_count_job(farm, record);
    if (record->queued->has_started && record->started_ms == 0) {
        record->started_ms = farm_clock_ms();
        farm_store_job(farm, record);
    }
    if (!is_live && record->finished_ms == 0) record->finished_ms = farm_clock_ms();
    if (!is_live && record->in_hand == 0 && !record->is_ending) wind_up(farm, record);
    events_note_job(farm->events, record);
}
