// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/job_life.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/limits.h"
#include "daemon/jobs/after_desk.h"
#include "daemon/jobs/events.h"
#include "daemon/jobs/frame_metrics.h"
#include "daemon/jobs/notice_watch.h"
#include "daemon/jobs/notices.h"
#include "daemon/output/sweeper.h"
#include "daemon/workers/worker_pool.h"

#include <stdlib.h>

static void drop_intents(struct farm *farm, struct job_record *record)
{
    while (record->intent_count > 0)
        farm_store(farm, store_op_reset_frame(record->id, record->intents[--record->intent_count].index));
}

// The end of the job is stored after it is swept, so that a restart sweeps it again after a crash.
static void end_job(struct farm *farm, struct job_record *record)
{
    struct log_subject subject = job_record_subject(record);

    record->is_ending = true;
    record->is_sweeping = true;
    drop_intents(farm, record);
    log_about(LOG_INFO, &subject, "job %lld (\"%s\"): %s", (long long)record->id, record->name,
              job_state_name(queue_job_state(record->queued)));
    worker_pool_forget_job(farm->pool, record->id);
    sweeper_sweep_job(farm->sweeper, record);
}

static void note_service(struct job_record *record)
{
    bool is_served = record->queued->states.counts[FRAME_RUNNING] > 0;

    if (is_served || record->is_served || !queue_job_is_live(record->queued)) record->served_ms = farm_clock_ms();
    record->is_served = is_served;
}

void job_life_note_change(struct farm *farm, struct job_record *record)
{
    bool is_live = queue_job_is_live(record->queued);

    limits_count_job(farm, record);
    if (record->queued->has_started && record->started_ms == 0) {
        record->started_ms = farm_clock_ms();
        frame_metrics_note_start(farm, record);
        farm_store_job(farm, record);
    }
    note_service(record);
    if (!is_live && record->finished_ms == 0) record->finished_ms = farm_clock_ms();
    if (!is_live && record->frames_in_flight == 0 && !record->is_ending) end_job(farm, record);
    after_desk_note_change(farm, record);
    events_note_job(farm->events, record);
}

void job_life_note_swept(struct farm *farm, struct job_record *record, bool was_away)
{
    record->is_sweeping = false;
    record->needs_sweep = was_away;
    record->is_swept = record->is_ending;
    if (!record->is_ending) {
        farm_store_job(farm, record);
        return;
    }
    notice_watch_look(farm, record); // a frame may have missed a moment ago
    notices_store_end(farm, record, job_record_format_op(record));
}

void job_life_hold(struct farm *farm, struct job_record *record, const char *why)
{
    struct log_subject subject = job_record_subject(record);
    char *reason;

    if (record->queued->is_paused || !queue_job_is_live(record->queued)) return;
    reason = xasprintf("paused: %s", why);
    job_record_set_reason(record, reason);
    log_about(LOG_WARN, &subject, "job %lld: %s", (long long)record->id, reason);
    free(reason);
    queue_pause(farm->queue, record->queued);
    worker_pool_drop_job(farm->pool, record->id, false);
    farm_store_job(farm, record);
    job_life_note_change(farm, record);
}

void job_life_fail(struct farm *farm, struct job_record *record, const char *why)
{
    job_record_set_reason(record, why);
    queue_fail_job(farm->queue, record->queued);
    worker_pool_drop_job(farm->pool, record->id, true);
    farm_store_job(farm, record);
}

void job_life_refuse(struct farm *farm, struct job_record *record, bool is_job_fault, const char *why)
{
    if (!queue_job_is_live(record->queued)) return;
    if (is_job_fault)
        job_life_fail(farm, record, why);
    else
        job_life_hold(farm, record, why);
    farm_want_feed(farm); // other workers may have left its frames to the one that did not start
    job_life_note_change(farm, record);
}
