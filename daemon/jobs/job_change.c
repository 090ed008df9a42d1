// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/job_change.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/after_desk.h"
#include "daemon/jobs/job_life.h"
#include "daemon/jobs/root_life.h"
#include "daemon/workers/worker_pool.h"

#include <stdlib.h>

static void log_change(const struct job_record *record, const char *what)
{
    struct log_subject subject = job_record_subject(record);

    log_about(LOG_INFO, &subject, "job %lld (\"%s\"): %s", (long long)record->id, record->name, what);
}

static void log_change_by(const struct job_record *record, const char *what, const char *user)
{
    char *text = xasprintf("%s by %s", what, user);

    log_change(record, text);
    free(text);
}

static void set_reason_by(struct job_record *record, const char *what, const char *user)
{
    char *reason = xasprintf("%s by %s", what, user);

    job_record_set_reason(record, reason);
    log_change(record, reason);
    free(reason);
}

void job_change_pause(struct farm *farm, struct job_record *record, const char *user)
{
    if (record->queued->is_paused) return;
    queue_pause(farm->queue, record->queued);
    set_reason_by(record, "paused", user);
    worker_pool_drop_job(farm->pool, record->id, false);
    job_life_note_change(farm, record);
}

void job_change_resume(struct farm *farm, struct job_record *record, const char *user)
{
    if (!record->queued->is_paused) {
        if (!record->waits) return;
        after_desk_release(farm, record);
        log_change_by(record, "waits for no other job: resumed", user);
        job_life_note_change(farm, record);
        return;
    }
    queue_resume(farm->queue, record->queued);
    job_record_set_reason(record, NULL);
    log_change_by(record, "resumed", user);
    root_life_check(farm, record, ROOT_LIFE_FOLDER_WANTED, NULL);
    farm_want_feed(farm);
    job_life_note_change(farm, record);
}

void job_change_cancel(struct farm *farm, struct job_record *record, const char *user)
{
    if (!queue_job_is_live(record->queued)) return;
    queue_cancel(farm->queue, record->queued);
    set_reason_by(record, "canceled", user);
    worker_pool_drop_job(farm->pool, record->id, true);
    farm_want_feed(farm);
    job_life_note_change(farm, record);
}

void job_change_set_priority(struct farm *farm, struct job_record *record, int priority, const char *user)
{
    char *what = xasprintf("priority %d, before %d, set", priority, record->queued->priority);

    log_change_by(record, what, user);
    free(what);
    queue_set_priority(farm->queue, record->queued, priority);
    farm_want_feed(farm);
    job_life_note_change(farm, record);
}
