// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/after_desk.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/after_look.h"
#include "daemon/jobs/events.h"
#include "daemon/loop/loop_turns.h"

#include <stdlib.h>

enum { LOOKED_AT_OF_A_STEP = 64 };

// Jobs are named by ids: by the time that one is looked at, it may be gone.
struct after_desk {
    struct loop_task task;
    struct farm *farm; // borrowed; outlives us
    int64_t *ids;      // owned; of jobs to look at
    size_t count, capacity, next;
};

static bool on_look_step(struct loop_task *task);

struct after_desk *after_desk_create(struct farm *farm)
{
    struct after_desk *desk = xcalloc(1, sizeof *desk);

    desk->task.step = on_look_step;
    desk->farm = farm;
    return desk;
}

void after_desk_destroy(struct after_desk *desk)
{
    if (!desk) return;
    free(desk->ids);
    free(desk);
}

void after_desk_start(struct after_desk *desk)
{
    if (desk->count > 0) loop_turns_put(desk->farm->turns, &desk->task);
}

static void put(struct after_desk *desk, int64_t id)
{
    desk->ids = xgrow(desk->ids, &desk->capacity, desk->count + 1, sizeof desk->ids[0]);
    desk->ids[desk->count++] = id;
    if (desk->farm->turns) loop_turns_put(desk->farm->turns, &desk->task);
}

bool after_desk_check(const struct farm *farm, const struct job_after *after, struct error *error)
{
    for (size_t i = 0; i < after->count; i++) {
        const struct job_record *first = job_table_find(&farm->jobs, after->ids[i]);

        if (first && !first->is_deleting) continue;
        error_set(error, "after[%zu]: job %lld %s", i, (long long)after->ids[i],
                  first ? "is being deleted" : "is not known");
        return false;
    }
    return true;
}

void after_desk_add(struct farm *farm, struct job_record *record)
{
    for (size_t i = 0; i < record->after.count; i++) {
        struct job_record *first = job_table_find(&farm->jobs, record->after.ids[i]);

        if (!first) continue;
        first->waiters =
            xgrow(first->waiters, &first->waiter_capacity, first->waiter_count + 1, sizeof first->waiters[0]);
        first->waiters[first->waiter_count++] = record->id;
    }
    put(farm->after, record->id);
}

void after_desk_note_change(struct farm *farm, struct job_record *record)
{
    int state = 1 + 2 * (int)queue_job_state(record->queued) + record->is_ending;

    if (record->waiter_count == 0 || state == record->told_waiters) return;
    record->told_waiters = state;
    after_desk_forget(farm, record);
}

void after_desk_forget(struct farm *farm, const struct job_record *record)
{
    for (size_t i = 0; i < record->waiter_count; i++)
        put(farm->after, record->waiters[i]);
}

bool after_desk_is_needed(const struct farm *farm, const struct job_record *record)
{
    for (size_t i = 0; i < record->waiter_count; i++) {
        const struct job_record *waiter = job_table_find(&farm->jobs, record->waiters[i]);

        if (waiter && waiter->waits && queue_job_is_live(waiter->queued)) return true;
    }
    return false;
}

void after_desk_release(struct farm *farm, struct job_record *record)
{
    record->waits = false;
    queue_set_wait(record->queued, QUEUE_WAITS_NOT);
    farm_want_feed(farm);
}

static void look_at(struct farm *farm, struct job_record *record)
{
    struct log_subject subject = job_record_subject(record);
    enum queue_wait wait = after_look_find_wait(farm, record);

    if (wait == record->queued->wait) return;
    if (wait == QUEUE_WAITS_NOT) {
        after_desk_release(farm, record);
        farm_store_job(farm, record);
        log_about(LOG_INFO, &subject, "job %lld (\"%s\"): goes on: what it waited for is over", (long long)record->id,
                  record->name);
    } else {
        char *reason;

        queue_set_wait(record->queued, wait);
        reason = after_look_format_reason(farm, record);
        log_about(LOG_INFO, &subject, "job %lld (\"%s\"): %s", (long long)record->id, record->name, reason);
        free(reason);
    }
    events_note_job(farm->events, record);
}

static bool on_look_step(struct loop_task *task)
{
    struct after_desk *desk = (struct after_desk *)task;

    for (int i = 0; i < LOOKED_AT_OF_A_STEP && desk->next < desk->count; i++) {
        struct job_record *record = job_table_find(&desk->farm->jobs, desk->ids[desk->next++]);

        if (record && record->waits) look_at(desk->farm, record);
    }
    if (desk->next < desk->count) return true;
    desk->next = desk->count = 0;
    return false;
}
