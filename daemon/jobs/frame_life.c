// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/frame_life.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/limits.h"
#include "daemon/farm/shares.h"
#include "daemon/jobs/events.h"
#include "daemon/jobs/feed.h"
#include "daemon/jobs/frame_metrics.h"
#include "daemon/jobs/job_life.h"
#include "daemon/jobs/late_sweep.h"
#include "daemon/jobs/plan_life.h"
#include "daemon/jobs/root_life.h"
#include "daemon/output/publisher.h"
#include "daemon/output/sweeper.h"
#include "daemon/schedule/retry.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/workers/job_fence.h"
#include "daemon/workers/worker_pool.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { EXIT_AFTER_FAULT_MS = 10000 };

// A failed attempt.
struct attempt_end {
    struct job_record *record;
    struct queue_ticket ticket;
    enum retry_fault fault;
    bool is_started;
    bool is_lost;                     // the worker is gone
    bool is_free;                     // the node of the worker is gone: neither frame nor worker is to blame
    bool is_remote;                   // the worker is on a node, which may not see what is here
    bool is_hosted;                   // the worker was started for another job
    bool is_old;                      // the output root has changed since the worker was fenced in
    const struct store_frame *intent; // of its file, in the store; NULL: none
    int worker;
    const char *error;
    const char *log;
};

static void log_attempt(enum log_level level, const struct job_record *record, const struct queue_ticket *ticket,
                        int worker, const char *text, const char *outcome)
{
    struct log_subject subject = job_record_subject(record);

    subject.frame = ticket->frame;
    subject.attempt = ticket->attempt;
    subject.worker = worker;
    log_about(level, &subject, "job %lld frame %d attempt %d: %s%s%s", (long long)ticket->job, ticket->frame,
              ticket->attempt, text, *outcome ? "; now " : "", outcome);
}

static void store_attempt(struct farm *farm, const struct attempt_end *end, const char *outcome)
{
    struct store_op op = {.kind = STORE_ADD_ATTEMPT,
                          .attempt = {.job = end->ticket.job,
                                      .frame = end->ticket.frame,
                                      .attempt = end->ticket.attempt,
                                      .worker = end->worker,
                                      .ended_ms = farm_clock_ms(),
                                      .log = xstrdup(end->log)}};

    strncpy(op.attempt.outcome, outcome, sizeof op.attempt.outcome - 1);
    farm_store(farm, op);
}

static void store_failed_frame(struct farm *farm, const struct attempt_end *end)
{
    farm_store(farm, (struct store_op){.kind = STORE_SET_FRAME,
                                       .frame = {.job = end->ticket.job,
                                                 .index = end->ticket.index,
                                                 .state = FRAME_FAILED,
                                                 .attempts = end->ticket.attempt,
                                                 .epoch = farm->epoch,
                                                 .error = xstrdup(end->error)}});
}

// Who published has seen itself that the root is gone; what a worker says is checked.
static void await_root(struct farm *farm, const struct attempt_end *end)
{
    queue_return(farm->queue, &end->ticket);
    if (end->intent)
        root_life_lose(farm, end->record->output_root, end->error);
    else
        root_life_check(farm, end->record, end->is_remote ? ROOT_LIFE_NODE_FAILED : ROOT_LIFE_ROOT_FAILED, end->error);
}

static bool is_hopeless(const struct queue_job *queued)
{
    return queue_job_is_live(queued) &&
           retry_gives_up_job(queued->states.counts[FRAME_FAILED],
                              queued->states.counts[FRAME_SUCCEEDED] + queued->states.counts[FRAME_SKIPPED]);
}

static enum retry_action decide(const struct farm *farm, const struct attempt_end *end)
{
    int tries = frame_states_at(&end->record->queued->states, end->ticket.index).tries;

    if (end->is_old && (end->fault == RETRY_FAULT_OUTPUT || end->fault == RETRY_FAULT_ROOT)) return RETRY_FREE;
    if (end->is_free) return RETRY_FREE;
    if (end->is_hosted && retry_blames_host(end->fault)) {
        if (end->is_started) end->record->needs_own_worker = true;
        return RETRY_FREE;
    }
    return retry_decide(end->fault, end->is_started, tries, farm->options->max_attempts);
}

// The ticket must own its frame.
static void end_attempt(struct farm *farm, const struct attempt_end *end)
{
    enum retry_action action = decide(farm, end);
    enum frame_state state;

    if (end->is_started) frame_metrics_note_fault(farm, end->worker, end->fault);
    switch (action) {
    case RETRY_FRAME:
    case RETRY_FAIL_FRAME:
        queue_fail(farm->queue, &end->ticket, action == RETRY_FAIL_FRAME, NULL);
        if (action == RETRY_FAIL_FRAME && end->fault >= RETRY_FAULT_LOST && is_hopeless(end->record->queued))
            job_life_fail(farm, end->record, end->error);
        break;
    case RETRY_FREE:
        queue_return(farm->queue, &end->ticket);
        break;
    case RETRY_FAIL_JOB:
        queue_fail(farm->queue, &end->ticket, true, NULL);
        job_life_fail(farm, end->record, end->error);
        break;
    case RETRY_PAUSE_JOB:
        queue_return(farm->queue, &end->ticket);
        root_life_check(farm, end->record, ROOT_LIFE_OUTPUT_FAILED, end->error);
        break;
    case RETRY_AWAIT_ROOT:
        await_root(farm, end);
        break;
    }
    // A frame of a job that was canceled in the meantime is canceled, which needs no row.
    state = frame_states_get(&end->record->queued->states, end->ticket.index);
    if (state == FRAME_FAILED)
        store_failed_frame(farm, end);
    else if (end->intent && state == FRAME_QUEUED && action == RETRY_AWAIT_ROOT)
        job_record_keep_intent(end->record, end->intent);
    else if (end->intent)
        farm_store(farm, store_op_reset_frame(end->ticket.job, end->ticket.index));
    if (end->is_started) {
        log_attempt(state == FRAME_FAILED ? LOG_WARN : LOG_INFO, end->record, &end->ticket, end->worker, end->error,
                    frame_state_name(state));
        store_attempt(farm, end, end->is_lost ? "lost" : "failed");
        events_send_frame(farm->events, &end->ticket, state, end->error);
    }
    farm_want_feed(farm);
}

// The attempt is over for its worker.
static void remove_frame(struct farm *farm, struct worker_process *worker, struct in_flight_frame *frame)
{
    struct queue_ticket ticket = frame->ticket;

    in_flight_remove(&worker->in_flight, frame);
    plan_life_leave(farm, &ticket);
}

static void release_frame(struct farm *farm, struct job_record *record, struct worker_process *worker,
                          struct in_flight_frame *frame)
{
    remove_frame(farm, worker, frame);
    record->frames_in_flight--;
}

static void note_pace(struct worker_process *worker, struct job_record *record, const struct worker_report *report)
{
    bool is_first;
    double seconds = pace_answer(&worker->pace, record->id, uv_hrtime(), &is_first);

    if (is_first)
        estimate_add_first(&record->estimate, seconds, report->render_s + report->audit_s + report->encode_s,
                           report->weight);
    else
        estimate_add_pace(&record->estimate, seconds, report->weight);
}

static void note_planned(struct farm *farm, struct worker_process *worker, struct job_record *record,
                         const struct worker_report *report)
{
    double seconds = pace_end_plan(&worker->pace, uv_hrtime());

    estimate_foretell(&record->estimate, report->foretold_s);
    if (seconds < 0) return;
    estimate_add_plan(&record->estimate, seconds, report->planned_frames);
    frame_metrics_note_plan(farm, worker, seconds);
}

static void note_finished(struct farm *farm, struct worker_process *worker, const struct worker_report *report,
                          struct job_record *record, struct in_flight_frame *frame)
{
    struct publish_request request = {.record = record,
                                      .ticket = frame->ticket,
                                      .worker = worker->id,
                                      .seen_by_ns =
                                          worker->node ? uv_hrtime() + PUBLISHER_SEEN_MS * UINT64_C(1000000) : 0,
                                      .reported_ns = uv_hrtime(),
                                      .epoch = farm->epoch,
                                      .file = report->file,
                                      .render_s = report->render_s,
                                      .encode_s = report->encode_s,
                                      .audit_s = report->audit_s,
                                      .accuracy = report->accuracy};

    worker->done++;
    if (report->is_found)
        estimate_add_skip(&record->estimate, pace_answer(&worker->pace, record->id, uv_hrtime(), NULL));
    else
        note_pace(worker, record, report);
    if (!queue_begin_publish(farm->queue, &frame->ticket)) {
        sweeper_remove_part(farm->sweeper, record, frame->ticket.frame, farm->epoch, frame->ticket.attempt);
        release_frame(farm, record, worker, frame);
        return;
    }
    remove_frame(farm, worker, frame);
    if (!report->is_found) frame_metrics_note_frame(farm, worker, report, record);
    estimate_add(&record->estimate, report->render_s + report->audit_s);
    publisher_put(farm->publisher, &request);
}

static void note_accuracy(const struct publish_request *request)
{
    job_record_note_accuracy(request->record, &request->accuracy);
    if (frame_accuracy_is_over(&request->accuracy, request->record->facts.tolerance))
        queue_note_missed(request->record->queued, request->ticket.index);
}

static void note_skipped(struct farm *farm, struct worker_process *worker, const struct worker_report *report,
                         struct job_record *record, struct in_flight_frame *frame)
{
    struct publish_request request = {.record = record,
                                      .ticket = frame->ticket,
                                      .worker = worker->id,
                                      .epoch = farm->epoch,
                                      .file = report->file,
                                      .accuracy = report->accuracy};

    worker->done++;
    estimate_add_skip(&record->estimate, pace_answer(&worker->pace, record->id, uv_hrtime(), NULL));
    if (!queue_begin_publish(farm->queue, &frame->ticket)) {
        release_frame(farm, record, worker, frame);
        return;
    }
    remove_frame(farm, worker, frame);
    publisher_put_found(farm->checker, &request);
}

static void note_failed(struct farm *farm, struct worker_process *worker, const struct worker_report *report,
                        struct job_record *record, struct in_flight_frame *frame)
{
    struct queue_ticket ticket = frame->ticket;
    char *log = worker_process_take_log(worker, report->error);
    struct attempt_end end = {.record = record,
                              .ticket = ticket,
                              .fault = report->fault,
                              .is_started = true,
                              .is_remote = worker->node != NULL,
                              .is_hosted = worker_process_is_host(worker, ticket.job),
                              .is_old = worker->fence && job_fence_is_old(worker->fence),
                              .worker = worker->id,
                              .error = report->error,
                              .log = log};

    log_disarm(log); // other users see it
    if (report->fault == RETRY_FAULT_ROOT) worker_process_doubt_node(worker, farm_now_ms(farm) + EXIT_AFTER_FAULT_MS);
    if (report->fault == RETRY_FAULT_WORKER)
        worker_process_expect_exit(worker, farm_now_ms(farm) + EXIT_AFTER_FAULT_MS);
    estimate_add_pace(&record->estimate, pace_answer(&worker->pace, record->id, uv_hrtime(), NULL), 1.0);
    pace_drop_plan(&worker->pace);
    release_frame(farm, record, worker, frame);
    if (queue_owns(farm->queue, &ticket)) end_attempt(farm, &end);
    sweeper_remove_part(farm->sweeper, record, ticket.frame, farm->epoch, ticket.attempt);
    free(log);
}

// Tells subscribers; the phase of a frame that is rendered, or no longer the ticket's, is old.
static void note_phase(struct farm *farm, struct job_record *record, struct in_flight_frame *frame,
                       enum frame_phase phase, double progress)
{
    if (frame->is_rendered) return;
    frame->phase = phase;
    frame->phase_progress = progress;
    if (!queue_owns(farm->queue, &frame->ticket)) return;
    events_send_phase(farm->events, frame);
    events_note_job(farm->events, record);
}

void frame_life_note_report(struct farm *farm, struct worker_process *worker, const struct worker_report *report)
{
    struct in_flight_frame *frame = in_flight_find(&worker->in_flight, report->job, report->frame, report->attempt);
    struct job_record *record = job_table_find(&farm->jobs, report->job);

    if (!frame || !record) return;
    switch (report->kind) {
    case WORKER_REPORT_STARTED:
        frame->is_started = true;
        frame->phase = FRAME_PHASE_RENDER;
        if (queue_owns(farm->queue, &frame->ticket))
            events_send_frame(farm->events, &frame->ticket, FRAME_RUNNING, NULL);
        return;
    case WORKER_REPORT_PLANNING:
        pace_begin_plan(&worker->pace, uv_hrtime());
        note_phase(farm, record, frame, FRAME_PHASE_PLAN, 0.0);
        return;
    case WORKER_REPORT_PLANNED:
        note_planned(farm, worker, record, report);
        note_phase(farm, record, frame, FRAME_PHASE_RENDER, 0.0);
        return;
    case WORKER_REPORT_PHASE:
        note_phase(farm, record, frame, report->phase, report->phase_progress);
        feed_note_rendering(worker, record);
        return;
    case WORKER_REPORT_PLAN_WANTED:
    case WORKER_REPORT_PLAN_MADE:
        plan_life_note_report(farm, report, record, frame);
        return;
    case WORKER_REPORT_RENDERED:
        in_flight_mark_rendered(&worker->in_flight, frame);
        feed_note_rendering(worker, record);
        farm_want_feed(farm);
        return;
    case WORKER_REPORT_FINISHED:
        note_finished(farm, worker, report, record, frame);
        break;
    case WORKER_REPORT_SKIPPED:
        note_skipped(farm, worker, report, record, frame);
        break;
    case WORKER_REPORT_FAILED:
        note_failed(farm, worker, report, record, frame);
        break;
    default:
        pace_drop_plan(&worker->pace);
        queue_return(farm->queue, &frame->ticket);
        release_frame(farm, record, worker, frame);
        break;
    }
    if (worker->in_flight.count == 0) worker_process_forget_log(worker); // no frame is left that it could belong to
    farm_want_feed(farm);
    job_life_note_change(farm, record);
}

// True for the frame that a killed worker was rendering, when a clock killed it over code of the user or over the limit
// of a frame.
static bool is_suspect(const struct worker_process *worker, const struct in_flight_frame *frame)
{
    return (worker->suspect_code || worker->is_over_limit) && frame->is_started && !frame->is_rendered;
}

void frame_life_lose_frames(struct farm *farm, struct worker_process *worker, const char *reason)
{
    char *log = worker_process_take_log(worker, reason);
    char *suspicion =
        worker->suspect_code ? xasprintf("%s: does density in %s end?", reason, worker->suspect_code) : NULL;

    log_disarm(log);
    frame_metrics_note_end(farm, worker);
    while (worker->in_flight.count > 0) {
        struct in_flight_frame frame = worker->in_flight.frames[0];
        struct job_record *record = job_table_find(&farm->jobs, frame.ticket.job);
        struct attempt_end end = {.record = record,
                                  .ticket = frame.ticket,
                                  .fault = is_suspect(worker, &frame) ? RETRY_FAULT_ENDLESS : RETRY_FAULT_LOST,
                                  .is_started = frame.is_started,
                                  .is_lost = true,
                                  .is_free = worker->is_node_lost,
                                  .is_hosted = worker_process_is_host(worker, frame.ticket.job),
                                  .worker = worker->id,
                                  .error = suspicion && is_suspect(worker, &frame) ? suspicion : reason,
                                  .log = log};

        release_frame(farm, record, worker, &worker->in_flight.frames[0]);
        if (frame.is_started)
            sweeper_remove_part(farm->sweeper, record, frame.ticket.frame, farm->epoch, frame.ticket.attempt);
        if (worker->is_node_lost) late_sweep_note(farm, record->id, worker->heartbeat_ms);
        if (queue_owns(farm->queue, &frame.ticket)) end_attempt(farm, &end);
        job_life_note_change(farm, record);
    }
    free(suspicion);
    free(log);
}

static enum retry_fault fault_of(enum publish_outcome outcome)
{
    if (outcome == PUBLISH_OUTCOME_NO_ROOT) return RETRY_FAULT_ROOT;
    return outcome == PUBLISH_OUTCOME_BAD_FOLDER ? RETRY_FAULT_OUTPUT : RETRY_FAULT_FRAME;
}

static void note_unpublished(struct farm *farm, const struct publish_request *request)
{
    const struct store_op intent = publish_request_format_op(request, FRAME_RUNNING);
    struct attempt_end end = {.record = request->record,
                              .ticket = request->ticket,
                              .fault = fault_of(request->outcome),
                              .is_started = true,
                              .intent = request->is_found ? NULL : &intent.frame,
                              .worker = request->worker,
                              .error = request->error,
                              .log = request->error};

    end_attempt(farm, &end);
    // The file may be in a root that comes back.
    if (!request->is_found && request->outcome != PUBLISH_OUTCOME_NO_ROOT)
        sweeper_remove_part(farm->sweeper, request->record, request->ticket.frame, request->epoch,
                            request->ticket.attempt);
}

// The file that the worker found is there.
static void note_found(struct farm *farm, const struct publish_request *request)
{
    if (!queue_skip(farm->queue, &request->ticket)) return;
    note_accuracy(request);
    frame_metrics_note_published(farm, request);
    farm_store(farm, publish_request_format_op(request, FRAME_SKIPPED));
    events_send_frame(farm->events, &request->ticket, FRAME_SKIPPED, NULL);
}

void frame_life_on_published(void *user, const struct publish_request *request)
{
    struct farm *farm = user;
    struct error reason;

    request->record->frames_in_flight--;
    farm_want_feed(farm); // the publisher was full, perhaps
    if (request->outcome != PUBLISH_OUTCOME_DONE) {
        note_unpublished(farm, request);
    } else if (request->is_found) {
        note_found(farm, request);
    } else if (queue_succeed(farm->queue, &request->ticket)) {
        note_accuracy(request);
        frame_metrics_note_published(farm, request);
        request->record->root_doubts = 0;
        log_attempt(LOG_DEBUG, request->record, &request->ticket, request->worker, "published", "");
        farm_store(farm, publish_request_format_op(request, FRAME_SUCCEEDED));
        shares_store_with_frame(farm, request->record->queued->turn.owner);
        request->record->disk_bytes += (int64_t)request->file.size_bytes;
        events_send_frame(farm->events, &request->ticket, FRAME_SUCCEEDED, NULL);
    }
    job_life_note_change(farm, request->record);
    if (!limits_check_disk(farm, request->record, &reason)) job_life_hold(farm, request->record, reason.message);
}
