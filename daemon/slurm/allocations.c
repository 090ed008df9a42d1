// SPDX-License-Identifier: Apache-2.0
#include "daemon/slurm/allocations.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/settings/pool_options.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum {
    SILENCE_MS = 10 * 1000, // what Slurm takes without an answer is in its queue after so long
    CANCEL_MS = 10 * 1000   // it is canceled again after so long
};

void allocations_init(struct allocations *allocations, const char *token, int count)
{
    *allocations = (struct allocations){
        .token = xstrdup(token), .all = xcalloc((size_t)count, sizeof allocations->all[0]), .count = count};
}

void allocations_finish(struct allocations *allocations)
{
    for (int i = 0; i < allocations->count; i++) {
        free(allocations->all[i].machine);
        free(allocations->all[i].reason);
    }
    free(allocations->all);
    free(allocations->token);
    *allocations = (struct allocations){0};
}

static void set_text(char **text, char *value)
{
    free(*text);
    *text = value;
}

static void end(struct allocation *allocation)
{
    allocation->state = ALLOCATION_NONE;
    // What Slurm says of the end that was asked for is no news.
    if (allocation->job) allocation->over_job = allocation->cancel_ms ? 0 : allocation->job;
    allocation->job = allocation->end_ms = allocation->whole_ms = allocation->cancel_ms = 0;
    allocation->is_short = false;
    set_text(&allocation->machine, NULL);
}

// May be `count` or more: one that was asked for when more were allowed. -1: the name is none of ours.
static int find(const struct allocations *allocations, const char *name)
{
    size_t length = strlen(allocations->token);
    char *end;
    long number;

    if (strncmp(name, allocations->token, length) != 0 || name[length] != '.') return -1;
    number = strtol(name + length + 1, &end, 10);
    return *end == '\0' && number >= 1 && number <= POOL_NODE_LIMIT ? (int)number - 1 : -1;
}

struct answer {
    struct allocations *allocations;
    int64_t asked_ms;
    bool is_check; // nothing is changed yet
};

// A job that lives. Another of the same name is the one too many, unless it is the one that is known.
static void take_living(struct allocations *allocations, int index, const struct slurm_row *row, int64_t asked_ms)
{
    struct allocation *allocation = &allocations->all[index];
    bool is_known = allocation->job == row->job;

    if (allocation->seen_job) {
        allocations->surplus_job = is_known ? allocation->seen_job : row->job;
        allocations->surplus_index = index;
        if (!is_known) return;
    }
    allocation->seen_job = row->job;
    if (row->phase == SLURM_OTHER) {
        if (allocation->state != ALLOCATION_RUNS) allocation->state = ALLOCATION_WAITS;
        set_text(&allocation->reason, xasprintf("Slurm's job %lld is %s", (long long)row->job, row->state));
        return;
    }
    if (row->phase == SLURM_WAITS) {
        allocation->state = ALLOCATION_WAITS;
        set_text(&allocation->reason, xasprintf("Slurm's job %lld waits: %s", (long long)row->job, row->reason));
        return;
    }
    if (allocation->state != ALLOCATION_RUNS || !is_known) {
        allocation->busy_ms = asked_ms;
        allocation->whole_ms = row->left_s > 0 ? row->left_s * 1000 : 0;
        allocation->cancel_ms = 0;
    }
    allocation->state = ALLOCATION_RUNS;
    allocation->end_ms = row->left_s >= 0 ? asked_ms + row->left_s * 1000 : 0;
    set_text(&allocation->machine, xstrdup(row->machine));
    set_text(&allocation->reason, NULL);
}

static char *format_end(const struct slurm_row *row)
{
    const char *on = *row->machine ? " on " : "";

    return xasprintf("Slurm's job %lld%s%s ended: %s%s%s%s", (long long)row->job, on, row->machine, row->state,
                     strcmp(row->reason, "None") == 0 ? "" : " (", strcmp(row->reason, "None") == 0 ? "" : row->reason,
                     strcmp(row->reason, "None") == 0 ? "" : ")");
}

static bool take(void *user, const struct slurm_row *row, struct error *error)
{
    struct answer *answer = user;
    int index = find(answer->allocations, row->name);
    bool lives = row->phase != SLURM_ENDS && row->phase != SLURM_IS_OVER;
    struct allocation *allocation;

    if (index < 0) {
        error_set(error, "expected a job of this pool, got \"%.60s\"", row->name);
        return false;
    }
    if (answer->is_check) return true;
    if (index >= answer->allocations->count) {
        if (!lives) return true;
        answer->allocations->surplus_job = row->job;
        answer->allocations->surplus_index = index;
        return true;
    }
    allocation = &answer->allocations->all[index];
    if (lives) {
        take_living(answer->allocations, index, row, answer->asked_ms);
    } else if (row->job == allocation->job ||
               (row->job == allocation->over_job && allocation->state == ALLOCATION_NONE)) {
        allocation->is_kept = true;
        if (!allocation->cancel_ms) set_text(&allocation->reason, format_end(row));
    }
    return true;
}

static void settle(struct allocation *allocation, int64_t asked_ms)
{
    bool was_there = allocation->state == ALLOCATION_WAITS || allocation->state == ALLOCATION_RUNS;

    if (allocation->seen_job) {
        allocation->job = allocation->seen_job;
    } else if (was_there) {
        if (!allocation->is_kept)
            set_text(&allocation->reason, xasprintf("Slurm knows no job %lld any more", (long long)allocation->job));
        end(allocation);
    } else if (allocation->state == ALLOCATION_ASKED && asked_ms >= allocation->sure_from_ms) {
        end(allocation);
    }
}

bool allocations_take_answer(struct allocations *allocations, char *text, int64_t asked_ms, struct error *error)
{
    struct answer answer = {.allocations = allocations, .asked_ms = asked_ms, .is_check = true};
    char *copy = xstrdup(text);
    bool ok = slurm_read_rows(copy, take, &answer, error);

    free(copy);
    if (!ok) return false;
    allocations->surplus_job = 0;
    for (int i = 0; i < allocations->count; i++) {
        allocations->all[i].seen_job = 0;
        allocations->all[i].is_kept = false;
    }
    answer.is_check = false;
    (void)slurm_read_rows(text, take, &answer, NULL);
    for (int i = 0; i < allocations->count; i++)
        settle(&allocations->all[i], asked_ms);
    allocations->is_known = true;
    return true;
}

int allocations_count(const struct allocations *allocations, enum allocation_state state)
{
    int count = 0;

    for (int i = 0; i < allocations->count; i++)
        count += allocations->all[i].state == state;
    return count;
}

int allocations_want(int64_t tasks, int workers, int min, int max)
{
    int64_t want = (tasks + workers - 1) / workers;

    if (want < min) return min;
    return want < max ? (int)want : max;
}

static bool is_leaving(const struct allocation *allocation)
{
    return allocation->cancel_ms > 0;
}

int allocations_find_to_ask(const struct allocations *allocations, int want)
{
    int none = -1, there = 0;

    if (!allocations->is_known) return -1;
    for (int i = allocations->count - 1; i >= 0; i--) {
        if (allocations->all[i].state == ALLOCATION_ASKED) return -1;
        if (allocations->all[i].state == ALLOCATION_NONE)
            none = i;
        else
            there += !is_leaving(&allocations->all[i]);
    }
    return there < want ? none : -1;
}

int allocations_find_to_cancel(const struct allocations *allocations, int want, int64_t idle_ms, int64_t now_ms)
{
    int there = 0, waiting = -1, idle = -1;

    for (int i = 0; i < allocations->count; i++) {
        const struct allocation *allocation = &allocations->all[i];

        if (allocation->state != ALLOCATION_WAITS && allocation->state != ALLOCATION_RUNS) continue;
        if (is_leaving(allocation)) {
            if (now_ms - allocation->cancel_ms >= CANCEL_MS) return i;
            continue;
        }
        there++;
        if (allocation->is_short) return i;
        if (allocation->state == ALLOCATION_WAITS)
            waiting = i;
        else if (now_ms - allocation->busy_ms >= idle_ms)
            idle = i;
    }
    if (there <= want) return -1;
    return waiting >= 0 ? waiting : idle;
}

void allocations_note_asked(struct allocations *allocations, int index)
{
    struct allocation *allocation = &allocations->all[index];

    allocation->state = ALLOCATION_ASKED;
    allocation->sure_from_ms = INT64_MAX;
    set_text(&allocation->reason, xstrdup("Slurm is asked for a machine"));
}

void allocations_note_job(struct allocations *allocations, int index, int64_t job, int64_t now_ms)
{
    struct allocation *allocation = &allocations->all[index];

    allocation->state = ALLOCATION_WAITS;
    allocation->job = job;
    allocation->busy_ms = now_ms;
    set_text(&allocation->reason, xasprintf("Slurm's job %lld waits", (long long)job));
}

void allocations_note_silence(struct allocations *allocations, int index, const char *trouble, int64_t now_ms)
{
    allocations->all[index].sure_from_ms = now_ms + SILENCE_MS;
    set_text(&allocations->all[index].reason, xstrdup(trouble));
}

void allocations_note_canceled(struct allocations *allocations, int index, const char *reason, int64_t now_ms)
{
    allocations->all[index].cancel_ms = now_ms;
    set_text(&allocations->all[index].reason, reason ? xstrdup(reason) : NULL);
}
