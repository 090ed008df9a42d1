// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/job/output_path.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/job_view.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/loop/work_desk.h"
#include "daemon/requests/cursor.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_reader.h"
#include "daemon/workers/worker_pool.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

// Details of frames and attempts are read from the store off the loop, with a connection per task.
enum { FRAMES_DEFAULT = 1000, FRAMES_LIMIT = 10000, ATTEMPTS_DEFAULT = 100, RUN_GAP = 16, FRAMES_OF_A_STEP = 8192 };

struct listed_frame {
    int32_t index, frame;
    int32_t attempt;
    uint16_t worker;
    uint8_t state, phase; // phase: enum frame_phase
    float phase_progress; // negative: unknown
    char *node;           // owned; of its worker; NULL: this machine, or no worker
};

struct frames_filter {
    unsigned states;
    char *range;  // owned; NULL: all frames
    int64_t from; // an index: frames before it are on earlier pages
    int64_t offset, limit;
};

struct details_task {
    struct work_piece piece;
    struct loop_task walk; // over the frames' states, until it ends
    struct frames_filter filter;
    struct frame_set numbers; // owned; of the filter's range
    int64_t walked;
    size_t frame_capacity;
    const struct farm *farm;     // borrowed; outlives us
    struct answer *answer;       // owned
    struct job_record *record;   // held: id, root and path never change
    const char *state_folder;    // borrowed; outlives us
    struct listed_frame *frames; // owned; by ascending index
    size_t frame_count, next;    // next: the first that is not written
    int64_t total;
    bool has_more;       // frames than the page holds
    int32_t attempts_of; // a frame; -1: all
    int limit;
    struct json_writer value;
    bool ok;
    enum message_code code; // of the error
    struct error error;
};

static void on_range_run(struct work_piece *piece);
static void on_range_done(struct work_piece *piece, bool was_run);
static bool on_walk_step(struct loop_task *walk);
static void on_frames_run(struct work_piece *piece);
static void on_log_run(struct work_piece *piece);
static void on_details_done(struct work_piece *piece, bool was_run);

static struct details_task *create_task(struct request *request, struct job_record *record)
{
    struct details_task *task = xcalloc(1, sizeof *task);

    task->record = record;
    job_record_hold(record);
    task->state_folder = request->farm->options->state_folder;
    task->farm = request->farm;
    task->code = MESSAGE_CODE_INTERNAL;
    task->answer = request_defer_answer(request, true);
    task->piece.uid = request->client->peer.uid;
    task->piece.done = on_details_done;
    return task;
}

static void on_flushed(void *user, bool ok, const struct error *error)
{
    struct details_task *task = user;

    work_desk_put(task->farm->work, &task->piece);
}

// The flush brings to disk what clients have seen already, if the store works, before the task reads it.
static void start_task(struct details_task *task, void (*run)(struct work_piece *piece))
{
    task->piece.run = run;
    committer_flush(task->farm->committer, on_flushed, task);
}

static void on_details_done(struct work_piece *piece, bool was_run)
{
    struct details_task *task = (struct details_task *)piece;

    if (!was_run && !task->ok) error_set(&task->error, "the daemon stops: ask the next one");
    if (task->ok)
        answer_send_result(task->answer, &task->value);
    else
        answer_send_error(task->answer, task->code, task->error.message);
    job_record_release(task->record);
    json_writer_finish(&task->value);
    frame_set_finish(&task->numbers);
    free(task->filter.range);
    for (size_t i = 0; i < task->frame_count; i++)
        free(task->frames[i].node);
    free(task->frames);
    free(task);
}

static bool read_cursor(struct request *request, int64_t *from)
{
    struct json_node node = json_node_child(&request->params, "cursor"),
                     offset = json_node_child(&request->params, "offset");
    const char *text;

    if (json_node_is_absent(&node)) return true;
    if (!json_node_is_absent(&offset)) return json_fail(&offset, &request->error, "expected none beside \"cursor\"");
    if (!json_read_string(&node, &text, &request->error)) return false;
    return cursor_parse(text, CURSOR_FRAMES, from) ||
           json_fail_expected(&node, &request->error, "\"next\" of a job.frames");
}

static bool read_filter(struct request *request, struct frames_filter *filter)
{
    const char *range;

    *filter = (struct frames_filter){0};
    if (!request_read_range(request, &range)) return false;
    filter->range = range ? xstrdup(range) : NULL;
    return request_read_set(request, "state", frame_state_names, ~0U, &filter->states) &&
           read_cursor(request, &filter->from) &&
           request_read_count(request, "offset", 0, FRAME_COUNT_LIMIT, 0, &filter->offset) &&
           request_read_count(request, "limit", 0, FRAMES_LIMIT, FRAMES_DEFAULT, &filter->limit);
}

static void note_worker(const struct worker_pool *pool, const struct details_task *task, struct listed_frame *listed)
{
    int64_t job = task->record->id;
    const struct worker_process *worker =
        listed->state == FRAME_RUNNING ? worker_pool_find_holder(pool, job, listed->frame, listed->attempt) : NULL;
    const struct in_flight_frame *frame =
        worker ? in_flight_find(&worker->in_flight, job, listed->frame, listed->attempt) : NULL;
    const char *node = worker ? worker_process_node(worker) : NULL;

    listed->node = node ? xstrdup(node) : NULL;
    listed->phase = frame ? (uint8_t)frame->phase : FRAME_PHASE_NONE;
    listed->phase_progress = frame ? (float)frame->phase_progress : -1.0F;
}

static void list_frame(struct details_task *task, int32_t index)
{
    const struct queue_job *queued = task->record->queued;
    struct queue_frame known;
    int32_t frame;

    if (task->filter.range && !frame_set_has(&task->numbers, frame_range_at(&queued->frames, index))) return;
    if (task->total++ < task->filter.offset || index < task->filter.from) return;
    task->has_more = (int64_t)task->frame_count == task->filter.limit;
    if (task->has_more) return;
    known = frame_states_at(&queued->states, index);
    frame = frame_range_at(&queued->frames, index);
    task->frames = xgrow(task->frames, &task->frame_capacity, task->frame_count + 1, sizeof task->frames[0]);
    task->frames[task->frame_count++] = (struct listed_frame){.index = index,
                                                              .frame = frame,
                                                              .attempt = known.attempt,
                                                              .worker = known.worker,
                                                              .state = (uint8_t)known.state};
    note_worker(task->farm->pool, task, &task->frames[task->frame_count - 1]);
}

// A range may name four million frames.
static void on_range_run(struct work_piece *piece)
{
    struct details_task *task = (struct details_task *)piece;

    task->ok = frame_set_parse(&task->numbers, task->filter.range, &task->error);
    if (task->ok) return;
    task->code = MESSAGE_CODE_PARAMS;
    error_prefix(&task->error, "params.range");
}

static void on_range_done(struct work_piece *piece, bool was_run)
{
    struct details_task *task = (struct details_task *)piece;

    if (!task->ok) {
        on_details_done(piece, was_run);
        return;
    }
    task->ok = false;
    task->piece.done = on_details_done;
    loop_turns_put(task->farm->turns, &task->walk);
}

// Each frame is listed as it is when the walk passes it.
static bool on_walk_step(struct loop_task *walk)
{
    struct details_task *task = (struct details_task *)((char *)walk - offsetof(struct details_task, walk));
    const struct queue_job *queued = task->record->queued;
    int64_t end;

    if (task->record->is_removed) {
        error_set(&task->error, "job %lld was deleted", (long long)task->record->id);
        on_details_done(&task->piece, true);
        return false;
    }
    end = frame_range_count(&queued->frames);
    if (end > task->walked + FRAMES_OF_A_STEP) end = task->walked + FRAMES_OF_A_STEP;
    for (; task->walked < end; task->walked++)
        if (task->filter.states & 1U << frame_states_get(&queued->states, task->walked))
            list_frame(task, (int32_t)task->walked);
    if (end < frame_range_count(&queued->frames)) return true;
    start_task(task, on_frames_run);
    return false;
}

enum request_outcome requests_job_frames(struct request *request)
{
    struct job_record *record = request_find_job(request);
    struct frames_filter filter;
    struct details_task *task;

    if (!record) return REQUEST_FAILED;
    request->code = MESSAGE_CODE_PARAMS;
    if (!read_filter(request, &filter)) {
        free(filter.range);
        return REQUEST_FAILED;
    }
    task = create_task(request, record);
    task->filter = filter;
    task->walk.step = on_walk_step;
    if (filter.range) {
        task->piece.run = on_range_run;
        task->piece.done = on_range_done;
        work_desk_put(request->farm->work, &task->piece);
    } else {
        loop_turns_put(request->farm->turns, &task->walk);
    }
    return REQUEST_DEFERRED;
}

static void write_maybe_integer(struct json_writer *writer, const char *key, bool is_known, int64_t integer)
{
    json_write_key(writer, key);
    if (is_known)
        json_write_integer(writer, integer);
    else
        json_write_null(writer);
}

static void write_path(const struct details_task *task, const struct listed_frame *frame, struct json_writer *writer)
{
    const struct output_path *path = &task->record->path;
    char name[OUTPUT_NAME_SIZE];
    char *full;

    output_path_format_name(path, frame->frame, name);
    full = xasprintf("%s/%s%s%s", task->record->root, path->folder, *path->folder ? "/" : "", name);
    json_write_string_member(writer, "path", full);
    free(full);
}

static void write_accuracy(struct details_task *task, const struct frame_accuracy *stored)
{
    struct frame_accuracy accuracy = *stored;

    accuracy.is_missed = frame_accuracy_is_over(&accuracy, task->record->facts.tolerance);
    frame_accuracy_write(&accuracy, &task->value);
}

// `row` may be NULL. The row of a frame that was queued again is outdated and not used.
static void write_frame(struct details_task *task, const struct listed_frame *frame, const struct store_frame *row)
{
    struct json_writer *writer = &task->value;
    bool is_done = frame->state == FRAME_SUCCEEDED || frame->state == FRAME_SKIPPED;
    bool has_file = row && is_done;
    bool has_times = has_file && frame->state == FRAME_SUCCEEDED;

    json_write_begin_object(writer);
    json_write_integer_member(writer, "frame", frame->frame);
    json_write_string_member(writer, "state", frame_state_name((enum frame_state)frame->state));
    json_write_integer_member(writer, "attempts", frame->attempt);
    write_maybe_integer(writer, "worker", frame->worker != 0, frame->worker);
    json_write_string_member(writer, "node", frame->node);
    json_write_number_member(writer, "render_s", has_times ? row->render_s : NAN);
    json_write_number_member(writer, "encode_s", has_times ? row->encode_s : NAN);
    json_write_number_member(writer, "audit_s", has_times ? row->audit_s : NAN);
    write_maybe_integer(writer, "size_bytes", has_file, has_file ? (int64_t)row->size_bytes : 0);
    json_write_string_member(writer, "hash", has_file && row->hash[0] ? row->hash : NULL);
    if (is_done)
        write_path(task, frame, writer);
    else
        json_write_string_member(writer, "path", NULL);
    json_write_string_member(writer, "error", row && frame->state == FRAME_FAILED ? row->error : NULL);
    job_view_write_phase((enum frame_phase)frame->phase, (double)frame->phase_progress, writer);
    if (has_file) write_accuracy(task, &row->accuracy);
    json_write_end_object(writer);
}

// Writes the listed frames without a row before `row`, then the frame of `row` if it is listed.
static bool on_frame_row(void *user, const struct store_frame *row, struct error *error)
{
    struct details_task *task = user;

    while (task->next < task->frame_count && task->frames[task->next].index < row->index)
        write_frame(task, &task->frames[task->next++], NULL);
    if (task->next < task->frame_count && task->frames[task->next].index == row->index)
        write_frame(task, &task->frames[task->next++], row);
    return true;
}

// Runs of frames are read together. A gap of more than RUN_GAP frames ends a run.
static bool write_frames(struct details_task *task, struct store_reader *reader)
{
    size_t first = 0;

    for (size_t i = 1; i <= task->frame_count; i++) {
        if (i < task->frame_count && task->frames[i].index - task->frames[i - 1].index <= RUN_GAP) continue;
        if (!store_read_frames(reader, task->record->id, task->frames[first].index, task->frames[i - 1].index,
                               on_frame_row, task, &task->error))
            return false;
        while (task->next < i)
            write_frame(task, &task->frames[task->next++], NULL);
        first = i;
    }
    return true;
}

static void write_next(struct details_task *task)
{
    char next[CURSOR_TEXT_SIZE];

    if (task->frame_count > 0) cursor_format(next, CURSOR_FRAMES, task->frames[task->frame_count - 1].index + 1);
    json_write_string_member(&task->value, "next", task->has_more && task->frame_count > 0 ? next : NULL);
}

static void on_frames_run(struct work_piece *piece)
{
    struct details_task *task = (struct details_task *)piece;
    struct store_reader *reader = store_reader_open(task->state_folder, &task->error);

    if (!reader) return;
    json_write_begin_object(&task->value);
    json_write_key(&task->value, "frames");
    json_write_begin_array(&task->value);
    task->ok = write_frames(task, reader);
    json_write_end_array(&task->value);
    write_next(task);
    json_write_integer_member(&task->value, "total", task->total);
    json_write_end_object(&task->value);
    store_reader_close(reader);
}

enum request_outcome requests_job_log(struct request *request)
{
    struct job_record *record = request_find_job(request);
    struct details_task *task;
    int64_t frame, limit;

    if (!record) return REQUEST_FAILED;
    request->code = MESSAGE_CODE_PARAMS;
    if (!request_read_count(request, "frame", 0, FRAME_NUMBER_LIMIT - 1, -1, &frame) ||
        !request_read_count(request, "limit", 1, STORE_ATTEMPT_LIMIT, ATTEMPTS_DEFAULT, &limit))
        return REQUEST_FAILED;
    task = create_task(request, record);
    task->attempts_of = (int32_t)frame;
    task->limit = (int)limit;
    start_task(task, on_log_run);
    return REQUEST_DEFERRED;
}

static bool on_attempt_row(void *user, const struct store_attempt *row, struct error *error)
{
    struct json_writer *writer = user;

    json_write_begin_object(writer);
    json_write_integer_member(writer, "frame", row->frame);
    json_write_integer_member(writer, "attempt", row->attempt);
    json_write_integer_member(writer, "worker", row->worker);
    json_write_number_member(writer, "ended", (double)row->ended_ms / 1000);
    json_write_string_member(writer, "outcome", row->outcome);
    json_write_string_member(writer, "log", row->log);
    json_write_end_object(writer);
    return true;
}

static void on_log_run(struct work_piece *piece)
{
    struct details_task *task = (struct details_task *)piece;
    struct store_reader *reader = store_reader_open(task->state_folder, &task->error);

    if (!reader) return;
    json_write_begin_object(&task->value);
    json_write_key(&task->value, "attempts");
    json_write_begin_array(&task->value);
    task->ok = store_read_attempts(reader, task->record->id, task->attempts_of, task->limit, on_attempt_row,
                                   &task->value, &task->error);
    json_write_end_array(&task->value);
    json_write_end_object(&task->value);
    store_reader_close(reader);
}
