// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/feed.h"

#include "core/base/error.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/job_life.h"
#include "daemon/output/publisher.h"
#include "daemon/schedule/dispatch.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_reader.h"
#include "daemon/workers/worker_pool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool write_job(struct farm *farm, const struct worker_process *worker, const struct job_record *record,
                      struct json_writer *writer, struct error *error)
{
    const char *node = worker_process_node(worker);
    char *document;

    if (!store_read_document(farm->reader, record->id, &document, error)) return false;
    message_begin_notification(writer, "worker.job");
    json_write_begin_object(writer);
    json_write_integer_member(writer, "job", record->id);
    json_write_integer_member(writer, "epoch", farm->epoch);
    json_write_string_member(writer, "root", record->root);
    json_write_string_member(writer, "root_id", record->output_root->id);
    json_write_string_member(writer, "farm_id", farm->id);
    json_write_string_member(writer, "owner", record->owner);
    json_write_bool_member(writer, "plans", true);
    if (node) json_write_string_member(writer, "node", node);
    if (record->has_old_parts) json_write_bool_member(writer, "old_parts", true);
    json_write_key(writer, "document");
    json_write_raw(writer, document, strlen(document));
    json_write_end_object(writer);
    message_end(writer);
    free(document);
    return true;
}

static void write_assignment(int64_t job, const struct queue_ticket *tickets, size_t count, struct json_writer *writer)
{
    message_begin_notification(writer, "worker.assign");
    json_write_begin_object(writer);
    json_write_integer_member(writer, "job", job);
    json_write_key(writer, "frames");
    json_write_begin_array(writer);
    for (size_t i = 0; i < count; i++) {
        json_write_begin_array(writer);
        json_write_integer(writer, tickets[i].frame);
        json_write_integer(writer, tickets[i].attempt);
        if (tickets[i].is_forced) json_write_bool(writer, true);
        json_write_end_array(writer);
    }
    json_write_end_array(writer);
    json_write_end_object(writer);
    message_end(writer);
}

static void give(struct farm *farm, struct worker_process *worker, struct job_record *record,
                 const struct queue_ticket *tickets, size_t count)
{
    if (worker->in_flight.count == 0) {
        pace_begin(&worker->pace, uv_hrtime());
        liveness_set_busy(&worker->liveness, true, farm_now_ms(farm));
    }
    for (size_t i = 0; i < count; i++)
        in_flight_add(&worker->in_flight, &tickets[i]);
    record->frames_in_flight += (int)count;
}

static void assign(struct farm *farm, struct worker_process *worker, const struct queue_ticket *tickets, size_t count)
{
    struct job_record *record = job_table_find(&farm->jobs, tickets[0].job);
    struct json_writer writer = {0};
    struct error error;

    if (worker_process_knows_job(worker, record->id) || write_job(farm, worker, record, &writer, &error)) {
        if (writer.length > 0) worker_process_learn_job(worker, record->id);
        write_assignment(record->id, tickets, count, &writer);
        give(farm, worker, record, tickets, count);
        worker_process_send(worker, &writer);
    } else {
        for (size_t i = 0; i < count; i++)
            queue_return(farm->queue, &tickets[i]);
        job_life_hold(farm, record, error.message); // the job cannot go on without its document; other jobs can
    }
    json_writer_finish(&writer);
    job_life_note_change(farm, record);
}

// Splits the frames that the worker has not rendered into a count for `job` and the time that the others take.
static void add_load(struct farm *farm, const struct in_flight *in_flight, int64_t job, struct dispatch_load *load)
{
    int64_t other_job = 0;
    double median_s = 0;

    for (size_t i = 0; i < in_flight->count; i++) {
        const struct in_flight_frame *frame = &in_flight->frames[i];

        if (frame->is_rendered) continue;
        if (frame->ticket.job == job) {
            load->in_flight++;
            continue;
        }
        if (frame->ticket.job != other_job) {
            struct job_record *record = job_table_find(&farm->jobs, frame->ticket.job);

            other_job = frame->ticket.job;
            median_s = record ? estimate_median_s(&record->estimate) : 0;
        }
        load->other_jobs_s += median_s > 0 ? median_s : HUGE_VAL;
    }
}

// Tells the worker to give back the frames of `job` that it has not begun.
static void recall(struct worker_process *worker, int64_t job)
{
    bool is_told = true;

    for (size_t i = 0; i < worker->in_flight.count; i++) {
        struct in_flight_frame *frame = &worker->in_flight.frames[i];

        if (frame->ticket.job != job || frame->is_started || frame->is_recalled) continue;
        frame->is_recalled = true;
        is_told = false;
    }
    if (!is_told) worker_process_drop_job(worker, job, false);
}

// Frames in hand do not keep a job waiting that comes before theirs.
static void recall_for(struct farm *farm, struct worker_process *worker, const struct turns_seat *seat,
                       const struct queue_job *next)
{
    for (size_t i = 0; i < worker->in_flight.count; i++) {
        const struct in_flight_frame *frame = &worker->in_flight.frames[i];
        const struct queue_job *job = queue_find_job(farm->queue, frame->ticket.job);

        if (job && job != next && !frame->is_started && !frame->is_recalled &&
            turns_outranks(queue_turns(farm->queue), seat, &next->turn, &job->turn))
            recall(worker, job->id);
    }
}

// How many more frames of the job the worker will have done before its machine goes.
static size_t count_fitting(struct farm *farm, int index, const struct queue_job *job)
{
    double left_s = worker_pool_left_s(farm->pool, index), frame_s;
    size_t in_flight, count;

    if (isinf(left_s)) return SIZE_MAX;
    frame_s = estimate_median_s(&job_table_find(&farm->jobs, job->id)->estimate);
    in_flight = worker_pool_ready_at(farm->pool, index)->in_flight.count;
    count = dispatch_count_fitting(frame_s, left_s, in_flight);
    if (count == 0 && in_flight == 0) worker_pool_note_short(farm->pool, index, frame_s);
    return count;
}

// The job whose turn it is, and whether the worker can serve it; NULL: none.
static struct queue_job *choose(struct farm *farm, int index, enum worker_fit *fit)
{
    const struct turns_seat *seat = worker_pool_seat(farm->pool, index);
    struct queue_job *next;

    while ((next = queue_choose_job(farm->queue, seat))) {
        *fit = count_fitting(farm, index, next) ? worker_pool_prepare(farm->pool, index, next) : WORKER_COVERED;
        if (*fit != WORKER_COVERED) break;
        turns_cover(queue_turns(farm->queue), &next->turn);
    }
    return next;
}

// Of the ready workers, those that may render the job.
static int count_workers(const int ready[static TURNS_KIND_LIMIT], const struct queue_job *job)
{
    int count = 0;

    for (int kind = 0; kind < TURNS_KIND_LIMIT; kind++)
        if (turns_may_serve(&(struct turns_seat){.kind = kind}, &job->turn)) count += ready[kind];
    return count;
}

static size_t count_to_assign(struct farm *farm, int index, const struct queue_job *next,
                              const int ready[static TURNS_KIND_LIMIT])
{
    const struct worker_process *worker = worker_pool_ready_at(farm->pool, index);
    struct job_record *record = job_table_find(&farm->jobs, next->id);
    struct dispatch_load load = {.frame_s = estimate_median_s(&record->estimate),
                                 .skip_run = record->estimate.skip_run,
                                 .skip_s = (double)record->estimate.skip_s,
                                 .left = next->states.counts[FRAME_QUEUED],
                                 .workers = count_workers(ready, next)};
    size_t fitting = count_fitting(farm, index, next), count;

    if (load.skip_run > 0 && publisher_is_full(farm->checker)) return 0; // workers find files faster than we check them
    add_load(farm, &worker->in_flight, next->id, &load);
    count = dispatch_count(&load);
    if (count > fitting) count = fitting;
    return count < DISPATCH_CHUNK_LIMIT ? count : DISPATCH_CHUNK_LIMIT;
}

// False when the worker has enough frames, or none can be assigned. `*is_searching`: the next is still searched for.
static bool feed_worker(struct farm *farm, int index, const int ready[static TURNS_KIND_LIMIT], bool *is_searching)
{
    struct queue_ticket tickets[DISPATCH_CHUNK_LIMIT];
    struct turns_seat *seat = worker_pool_seat(farm->pool, index);
    struct worker_process *worker = worker_pool_ready_at(farm->pool, index);
    struct queue_job *next;
    enum worker_fit fit = WORKER_COVERED;
    size_t count = 0;

    if (!worker || worker_pool_is_behind(farm->pool, index)) return false;
    worker->next_job = 0;
    next = choose(farm, index, &fit);
    if (!next && worker->in_flight.count == 0) turns_stand(queue_turns(farm->queue), seat);
    if (!next || fit == WORKER_CHANGES) return false;
    if (fit == WORKER_FITS) count = count_to_assign(farm, index, next, ready);
    if (count == 0) {
        recall_for(farm, worker, seat, next);
        return false;
    }
    worker_pool_charge(farm->pool, index);
    turns_sit(queue_turns(farm->queue), seat, &next->turn, false);
    count = queue_take(next, (uint16_t)worker->id, tickets, count);
    if (count > 0)
        assign(farm, worker, tickets, count);
    else
        *is_searching = true;
    return count > 0;
}

bool feed_workers(struct farm *farm)
{
    int ready[TURNS_KIND_LIMIT];
    bool is_searching = false;

    if (committer_trouble(farm->committer) || farm->drain.user) return true;
    if (publisher_is_full(farm->publisher)) return true;
    worker_pool_count_ready(farm->pool, ready);
    turns_advance(queue_turns(farm->queue), farm_now_ms(farm));
    for (int i = 0; i < worker_pool_slot_count(farm->pool) && !is_searching; i++) {
        while (feed_worker(farm, i, ready, &is_searching)) {
        }
        turns_uncover(queue_turns(farm->queue)); // what another worker is to take must be there for that one
    }
    return !is_searching;
}

void feed_recall_all(struct farm *farm)
{
    for (int i = 0; i < worker_pool_slot_count(farm->pool); i++) {
        struct worker_process *worker = worker_pool_ready_at(farm->pool, i);

        for (size_t k = 0; worker && k < worker->in_flight.count; k++)
            recall(worker, worker->in_flight.frames[k].ticket.job);
    }
}

void feed_note_rendering(struct worker_process *worker, struct job_record *record)
{
    size_t count = 0;

    for (size_t i = 0; i < worker->in_flight.count; i++) {
        const struct in_flight_frame *frame = &worker->in_flight.frames[i];

        count += frame->ticket.job == record->id && !frame->is_started && !frame->is_recalled;
    }
    estimate_end_skips(&record->estimate);
    if (dispatch_is_overfull(estimate_median_s(&record->estimate), count)) recall(worker, record->id);
}
