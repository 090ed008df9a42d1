// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/notice_watch.h"

#include "core/base/alloc.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/after_look.h"
#include "daemon/jobs/job_view.h"
#include "daemon/jobs/notices.h"
#include "daemon/store/committer.h"

#include <stdlib.h>
#include <string.h>

enum { TICK_MS = 1000, JOBS_OF_A_TICK = 100 };

struct notice_watch {
    struct farm *farm; // borrowed; outlives us
    uv_timer_t timer;
    int64_t next; // id of the job that is looked at next
};

static void on_tick(uv_timer_t *timer);
static void on_closed(uv_handle_t *handle);

struct notice_watch *notice_watch_open(struct farm *farm)
{
    struct notice_watch *watch = xcalloc(1, sizeof *watch);

    watch->farm = farm;
    uv_timer_init(farm->loop, &watch->timer);
    watch->timer.data = watch;
    uv_timer_start(&watch->timer, on_tick, TICK_MS, TICK_MS);
    return watch;
}

void notice_watch_close(struct notice_watch *watch)
{
    if (watch) uv_close((uv_handle_t *)&watch->timer, on_closed);
}

static void on_closed(uv_handle_t *handle)
{
    free(handle->data);
}

// A pause by a user, a drain and a store that does not commit are no causes: somebody wants them, or knows.
static char *find_why(const struct farm *farm, const struct job_record *record, enum notice_cause cause)
{
    const struct queue_job *queued = record->queued;
    static const char by_fault[] = "paused: ";

    if (!queue_job_is_live(queued)) return NULL;
    switch (cause) {
    case NOTICE_HELD:
        if (!queued->is_paused && queued->wait == QUEUE_WAITS_IN_VAIN) return after_look_format_reason(farm, record);
        if (!queued->is_paused || !record->reason || strncmp(record->reason, by_fault, strlen(by_fault)) != 0)
            return NULL;
        return xstrdup(record->reason);
    case NOTICE_ROOT:
        return !queued->is_paused && queued->block == QUEUE_AWAY ? root_format_reason(record->output_root) : NULL;
    default:
        if (queued->is_paused || queued->block != QUEUE_OPEN || queued->wait != QUEUE_WAITS_NOT || farm->drain.user ||
            committer_trouble(farm->committer))
            return NULL;
        if (queued->states.counts[FRAME_QUEUED] == 0 || queued->states.counts[FRAME_RUNNING] > 0) return NULL;
        return job_view_format_lack(farm, record);
    }
}

static void look_at(struct farm *farm, struct job_record *record, enum notice_cause cause)
{
    bool is_missed = cause == NOTICE_MISSED;
    char *why = is_missed ? NULL : find_why(farm, record, cause);
    bool is_there = is_missed ? record->queued->states.missed_count > 0 : why != NULL;
    struct notice_told *told = &record->told[cause];
    enum notice_step step = notice_causes_note(told, cause, is_there, farm_clock_ms());
    const struct notice notice = {
        .record = record, .event = is_missed ? JOB_NOTIFY_MISSED : JOB_NOTIFY_WAITING, .why = why};
    struct store_op op = {.kind = STORE_SET_TOLD,
                          .told = {.job = record->id, .cause = cause, .told_ms = told->told_ms, .is_on = told->is_on}};

    if (step == NOTICE_TELL)
        notices_store_with(farm, &notice, op);
    else if (step == NOTICE_FORGET)
        farm_store(farm, op);
    free(why);
}

void notice_watch_look(struct farm *farm, struct job_record *record)
{
    if (record->is_end_told || record->is_removed || record->is_unreadable) return;
    if (notices_are_wanted(farm, record, JOB_NOTIFY_WAITING))
        for (int cause = NOTICE_HELD; cause <= NOTICE_WORKERS; cause++)
            look_at(farm, record, (enum notice_cause)cause);
    if (notices_are_wanted(farm, record, JOB_NOTIFY_MISSED)) look_at(farm, record, NOTICE_MISSED);
}

static void on_tick(uv_timer_t *timer)
{
    struct notice_watch *watch = timer->data;
    const struct job_table *jobs = &watch->farm->jobs;
    size_t i = job_table_first_from(jobs, watch->next);
    int looked = 0;

    for (; i < jobs->count && looked < JOBS_OF_A_TICK; i++) {
        looked += !jobs->records[i]->is_end_told;
        watch->next = jobs->records[i]->id + 1;
        notice_watch_look(watch->farm, jobs->records[i]);
    }
    if (i == jobs->count) watch->next = 0;
}
