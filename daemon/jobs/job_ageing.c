// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/job_ageing.h"

#include "core/base/alloc.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/after_desk.h"
#include "daemon/jobs/job_delete.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/loop/work_desk.h"
#include "daemon/schedule/keep.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

enum { FIRST_MS = 1000, INTERVAL_MS = 10 * 1000, LOOKED_AT_OF_A_STEP = 1024 };

struct job_ageing {
    struct loop_task task;
    struct work_piece sort;
    struct farm *farm;     // borrowed; outlives us
    int64_t due_ms;        // monotonic; of the next look
    int64_t next_id;       // to look at
    struct keep_job *jobs; // owned; those that are over
    size_t count, capacity;
    struct keep_choice choice;
    size_t next; // of the jobs that leave
    bool is_busy, is_stopped;
};

static bool on_look_step(struct loop_task *task);
static void on_sort_run(struct work_piece *piece);
static void on_sorted(struct work_piece *piece, bool was_run);
static bool on_delete_step(struct loop_task *task);
static void on_deleted(void *user);

struct job_ageing *job_ageing_create(struct farm *farm)
{
    struct job_ageing *ageing = xcalloc(1, sizeof *ageing);

    ageing->farm = farm;
    ageing->due_ms = farm_now_ms(farm) + FIRST_MS;
    return ageing;
}

void job_ageing_destroy(struct job_ageing *ageing)
{
    if (!ageing) return;
    free(ageing->jobs);
    free(ageing);
}

void job_ageing_stop(struct job_ageing *ageing)
{
    ageing->is_stopped = true;
}

void job_ageing_note_settings(struct job_ageing *ageing)
{
    ageing->due_ms = 0;
}

static struct keep_rules rules_of(const struct options *options)
{
    return (struct keep_rules){.jobs = options->keep_jobs, .ms = options->keep_ms, .bytes = options->keep_bytes};
}

static bool has_rules(const struct options *options)
{
    return options->keep_jobs > 0 || options->keep_ms > 0 || options->keep_bytes > 0;
}

static void end_look(struct job_ageing *ageing)
{
    ageing->is_busy = false;
    ageing->due_ms = farm_now_ms(ageing->farm) + INTERVAL_MS;
    ageing->count = 0;
}

void job_ageing_run(struct job_ageing *ageing)
{
    if (ageing->is_busy || farm_now_ms(ageing->farm) < ageing->due_ms) return;
    if (!has_rules(ageing->farm->options)) {
        end_look(ageing);
        return;
    }
    ageing->is_busy = true;
    ageing->next_id = 0;
    ageing->task.step = on_look_step;
    loop_turns_put(ageing->farm->turns, &ageing->task);
}

// Over, with nothing left to be done for it, and nobody needs it.
static bool may_leave(const struct farm *farm, const struct job_record *record)
{
    return !queue_job_is_live(record->queued) && record->is_swept && !record->is_sweeping && !record->needs_sweep &&
           record->frames_in_flight == 0 && !record->is_deleting && !record->is_retry_waiting && !record->is_retrying &&
           !after_desk_is_needed(farm, record);
}

static void note_job(struct job_ageing *ageing, const struct job_record *record)
{
    ageing->jobs = xgrow(ageing->jobs, &ageing->capacity, ageing->count + 1, sizeof ageing->jobs[0]);
    ageing->jobs[ageing->count++] =
        (struct keep_job){.id = record->id, .finished_ms = record->finished_ms, .bytes = record->disk_bytes};
}

static bool on_look_step(struct loop_task *task)
{
    struct job_ageing *ageing = (struct job_ageing *)task;
    const struct job_table *jobs = &ageing->farm->jobs;
    size_t i = job_table_first_from(jobs, ageing->next_id), end = i + LOOKED_AT_OF_A_STEP;

    if (ageing->is_stopped) return false;
    for (; i < jobs->count && i < end; i++) {
        if (may_leave(ageing->farm, jobs->records[i])) note_job(ageing, jobs->records[i]);
        ageing->next_id = jobs->records[i]->id + 1;
    }
    if (i < jobs->count) return true;
    ageing->sort = (struct work_piece){.run = on_sort_run, .done = on_sorted, .uid = ageing->farm->rights.daemon_uid};
    work_desk_put(ageing->farm->work, &ageing->sort);
    return false;
}

static void on_sort_run(struct work_piece *piece)
{
    struct job_ageing *ageing = (struct job_ageing *)((char *)piece - offsetof(struct job_ageing, sort));

    keep_sort(ageing->jobs, ageing->count);
}

static void on_sorted(struct work_piece *piece, bool was_run)
{
    struct job_ageing *ageing = (struct job_ageing *)((char *)piece - offsetof(struct job_ageing, sort));
    const struct keep_rules rules = rules_of(ageing->farm->options);

    if (!was_run || ageing->is_stopped) return;
    ageing->choice = keep_choose(&rules, ageing->jobs, ageing->count, farm_clock_ms());
    ageing->next = 0;
    ageing->task.step = on_delete_step;
    loop_turns_put(ageing->farm->turns, &ageing->task);
}

// The next one that may still leave; NULL: none is left.
static struct job_record *find_next(struct job_ageing *ageing, const char **rule)
{
    while (ageing->next < ageing->choice.count) {
        struct job_record *record = job_table_find(&ageing->farm->jobs, ageing->jobs[ageing->next].id);

        *rule = keep_rule_of(&ageing->choice, ageing->next++);
        if (record && may_leave(ageing->farm, record)) return record;
    }
    return NULL;
}

// One deletion at a time: those that users ask for come between.
static bool on_delete_step(struct loop_task *task)
{
    struct job_ageing *ageing = (struct job_ageing *)task;
    struct job_record *record;
    const char *rule;
    char who[32];

    if (ageing->is_stopped) return false;
    record = committer_trouble(ageing->farm->committer) ? NULL : find_next(ageing, &rule);
    if (!record) {
        end_look(ageing);
        return false;
    }
    snprintf(who, sizeof who, "marchd (%s)", rule);
    job_delete_start(ageing->farm, record,
                     &(struct job_delete_params){.user = who, .on_end = on_deleted, .end_user = ageing});
    return false;
}

static void on_deleted(void *user)
{
    struct job_ageing *ageing = user;

    if (!ageing->is_stopped) loop_turns_put(ageing->farm->turns, &ageing->task);
}
