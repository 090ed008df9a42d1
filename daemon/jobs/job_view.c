// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/job_view.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/pool_access.h"
#include "daemon/jobs/after_look.h"
#include "daemon/jobs/job_etas.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/workers/worker_pool.h"

#include <math.h>
#include <stdlib.h>

static void write_pattern(const struct job_record *record, struct json_writer *writer)
{
    const struct output_path *path = &record->path;
    char marks[32];
    char *pattern;
    int count = 0;

    for (; count < path->pad && count < (int)sizeof marks - 1; count++)
        marks[count] = '#';
    marks[count] = '\0';
    pattern = xasprintf("%s/%s%s%s%s%s", record->root, path->folder, *path->folder ? "/" : "", path->prefix, marks,
                        path->suffix);
    json_write_string_member(writer, "output", pattern);
    free(pattern);
}

static void write_time(struct json_writer *writer, const char *key, int64_t unix_ms)
{
    json_write_key(writer, key);
    if (unix_ms)
        json_write_number(writer, (double)unix_ms / 1000);
    else
        json_write_null(writer);
}

// What its owner used of the farm for their weight.
static double find_use(const struct queue_job *job)
{
    return job->turn.owner->used_s / job->turn.owner->weight;
}

// Who is before the job, which is not the next one.
static char *format_turn(const struct farm *farm, const struct job_record *record, const struct queue_job *next)
{
    const struct queue_job *queued = record->queued,
                           *own = queue_find_job(farm->queue, turns_first_of_lane(&queued->turn)->id);
    const struct job_record *other;

    if (own != queued) return xasprintf("waits behind job %lld (priority %d)", (long long)own->id, own->priority);
    if (next->turn.owner == queued->turn.owner)
        return xasprintf("waits behind job %lld (priority %d)", (long long)next->id, next->priority);
    other = job_table_find(&farm->jobs, next->id);
    if (next->priority != queued->priority)
        return xasprintf("waits behind job %lld of %s (priority %d)", (long long)next->id, other->owner,
                         next->priority);
    if (find_use(next) < find_use(queued))
        return xasprintf("waits behind job %lld of %s, who has used less of the farm lately", (long long)next->id,
                         other->owner);
    return xasprintf("waits behind job %lld of %s, whose turn it is", (long long)next->id, other->owner);
}

// The job that is next for a ready worker of those that may render this one; NULL: none.
static const struct queue_job *find_next(const struct farm *farm, const struct queue_job *job)
{
    struct turns_seat seat = {0};
    int ready[TURNS_KIND_LIMIT];

    worker_pool_count_ready(farm->pool, ready);
    while (seat.kind < TURNS_KIND_LIMIT - 1 && (ready[seat.kind] == 0 || !turns_may_serve(&seat, &job->turn)))
        seat.kind++;
    return queue_choose_job(farm->queue, &seat);
}

// Why no pool's workers may render it; NULL: some may. Owned by the caller.
static char *format_lack(const struct farm *farm, const struct job_record *record)
{
    struct error error = {0};

    if (!record->pool && record->queued->turn.barred == 0) return NULL;
    if (pool_access_check(farm, record->user, record->pool, &error)) return NULL;
    return xasprintf("waits: %s", error.message);
}

char *job_view_format_lack(const struct farm *farm, const struct job_record *record)
{
    char *trouble = format_lack(farm, record);

    return trouble ? trouble : worker_pool_format_trouble(farm->pool, record);
}

static char *reason_to_wait(const struct farm *farm, const struct job_record *record)
{
    const char *store_trouble = committer_trouble(farm->committer);
    const struct queue_job *next;
    char *trouble;

    if (store_trouble) return xstrdup(store_trouble);
    if (record->queued->states.counts[FRAME_QUEUED] == 0) return NULL;
    if (record->queued->wait == QUEUE_WAITS) return after_look_format_reason(farm, record);
    if (farm->drain.user) return farm_format_drain(farm);
    if (record->queued->states.counts[FRAME_RUNNING] > 0) return NULL;
    if (record->queued->block == QUEUE_IN_DOUBT) return xstrdup("its output is looked at");
    trouble = job_view_format_lack(farm, record);
    if (trouble) return trouble;
    next = find_next(farm, record->queued);
    if (next && next != record->queued) return format_turn(farm, record, next);
    return record->pool ? xasprintf("waits for a free worker of pool %s", record->pool)
                        : xstrdup("waits for a free worker");
}

// Why the job waits, is paused or failed, or what is wrong with its files; NULL: no reason. Owned by the caller.
static char *format_reason(const struct farm *farm, const struct job_record *record)
{
    const struct queue_job *queued = record->queued;

    switch (queue_job_state(queued)) {
    case JOB_QUEUED:
    case JOB_RUNNING:
        return reason_to_wait(farm, record);
    case JOB_FAILED:
        if (record->reason) return xstrdup(record->reason);
        return xasprintf("%lld of its frames failed", (long long)queued->states.counts[FRAME_FAILED]);
    case JOB_SUCCEEDED:
        if (queued->states.missed_count == 0) return NULL;
        return xasprintf("%lld of its frames missed the tolerance", (long long)queued->states.missed_count);
    case JOB_PAUSED:
        if (!queued->is_paused && queued->block == QUEUE_AWAY) return root_format_reason(record->output_root);
        if (!queued->is_paused) return after_look_format_reason(farm, record);
        return record->reason ? xstrdup(record->reason) : NULL;
    case JOB_CANCELED:
        return record->reason ? xstrdup(record->reason) : NULL;
    default:
        return NULL;
    }
}

static void write_counts(const struct queue_job *queued, struct json_writer *writer)
{
    json_write_integer_member(writer, "frames", frame_range_count(&queued->frames));
    for (int state = 0; state < FRAME_STATE_COUNT; state++)
        json_write_integer_member(writer, frame_state_name((enum frame_state)state), queued->states.counts[state]);
    json_write_integer_member(writer, "missed", queued->states.missed_count);
}

static void write_pace(const struct farm *farm, struct job_etas *etas, struct job_record *record,
                       struct json_writer *writer)
{
    const struct queue_job *queued = record->queued;
    double each_s = estimate_each_s(&record->estimate), eta_s = -1;

    if (queue_job_is_live(queued) && queued->wait == QUEUE_WAITS_NOT) eta_s = job_etas_find_s(etas, farm, record);
    json_write_number_member(writer, "seconds_per_frame", each_s > 0 ? each_s : NAN);
    json_write_number_member(writer, "eta_s", eta_s >= 0 ? eta_s : NAN);
}

void job_view_write_phase(enum frame_phase phase, double progress, struct json_writer *writer)
{
    json_write_string_member(writer, "phase", phase != FRAME_PHASE_NONE ? frame_phase_names[phase] : NULL);
    json_write_number_member(writer, "phase_progress", progress >= 0.0 ? progress : NAN);
}

static void write_accuracy(const struct job_record *record, struct json_writer *writer)
{
    const struct job_accuracy *latest = &record->latest;
    const struct job_facts *facts = &record->facts;
    const char *stated =
        facts->method == JOB_METHOD_AUTO || record->is_unreadable ? NULL : job_method_name(facts->method);

    json_write_number_member(writer, "tolerance", facts->tolerance > 0 ? facts->tolerance : NAN);
    json_write_string_member(writer, "method", latest->method[0] ? latest->method : stated);
    json_write_number_member(writer, "measured_error", latest->error > 0 ? latest->error : NAN);
    json_write_number_member(writer, "error95", latest->error95 > 0 ? latest->error95 : NAN);
}

static void write_after(const struct job_record *record, struct json_writer *writer)
{
    json_write_key(writer, "after");
    json_write_begin_array(writer);
    for (size_t i = 0; i < record->after.count && record->waits; i++)
        json_write_integer(writer, record->after.ids[i]);
    json_write_end_array(writer);
}

// What it is, and how far.
static void write_outline(const struct job_record *record, struct json_writer *writer)
{
    const struct queue_job *queued = record->queued;

    json_write_integer_member(writer, "id", record->id);
    json_write_string_member(writer, "name", record->name);
    json_write_string_member(writer, "state", job_state_name(queue_job_state(queued)));
    json_write_bool_member(writer, "draft", record->facts.is_draft);
    json_write_integer_member(writer, "priority", queued->priority);
    json_write_string_member(writer, "owner", record->owner);
    write_time(writer, "submitted", record->submitted_ms);
    write_time(writer, "started", record->started_ms);
    write_time(writer, "finished", record->finished_ms);
    write_counts(queued, writer);
}

void job_view_write_members(const struct farm *farm, struct job_etas *etas, struct job_record *record,
                            struct json_writer *writer)
{
    const struct queue_job *queued = record->queued;
    const struct in_flight_frame *frame = worker_pool_furthest_frame(farm->pool, record->id);
    char *range = frame_range_format(&queued->frames);
    char *reason = format_reason(farm, record);

    write_outline(record, writer);
    json_write_integer_member(writer, "owner_uid", record->owner_uid);
    write_accuracy(record, writer);
    json_write_string_member(writer, "range", range);
    write_pattern(record, writer);
    json_write_string_member(writer, "pool", record->pool);
    write_pace(farm, etas, record, writer);
    job_view_write_phase(frame ? frame->phase : FRAME_PHASE_NONE, frame ? frame->phase_progress : -1.0, writer);
    json_write_string_member(writer, "reason", reason);
    write_after(record, writer);
    job_notes_write_members(&record->notes, writer);
    free(range);
    free(reason);
}

void job_view_write_outline(const struct farm *farm, struct job_record *record, const char *why,
                            struct json_writer *writer)
{
    char *reason = why ? xstrdup(why) : format_reason(farm, record);

    write_outline(record, writer);
    write_pattern(record, writer);
    json_write_string_member(writer, "pool", record->pool);
    json_write_string_member(writer, "reason", reason);
    job_notes_write_members(&record->notes, writer);
    free(reason);
}

void job_view_write(const struct farm *farm, struct job_etas *etas, struct job_record *record,
                    struct json_writer *writer)
{
    json_write_begin_object(writer);
    job_view_write_members(farm, etas, record, writer);
    json_write_end_object(writer);
}
