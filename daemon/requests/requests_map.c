// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/loop/work_desk.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_reader.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

enum { MAP_LIMIT = 50000 };

static const char state_letters[FRAME_STATE_COUNT] = {
    [FRAME_QUEUED] = 'q', [FRAME_RUNNING] = 'r',  [FRAME_SUCCEEDED] = 's',
    [FRAME_FAILED] = 'f', [FRAME_CANCELED] = 'c', [FRAME_SKIPPED] = 'k',
};

// What is known of a frame that is done; 0: unknown.
struct map_frame {
    float seconds, error, error95;
};

// A frame is a letter and two numbers. States are those of one moment; the numbers are read from the store off the
// loop.
struct map_task {
    struct work_piece piece;
    const struct farm *farm;   // borrowed; outlives us
    struct answer *answer;     // owned
    struct job_record *record; // held
    const char *state_folder;  // borrowed; outlives us
    int64_t offset, count;     // indices in the job's range
    char *states;              // owned
    struct map_frame *frames;  // owned
    struct json_writer value;
    bool ok;
    struct error error;
};

static void on_flushed(void *user, bool ok, const struct error *error);
static void on_map_run(struct work_piece *piece);
static void on_map_done(struct work_piece *piece, bool was_run);

static void copy_states(struct map_task *task)
{
    const struct frame_states *states = &task->record->queued->states;

    task->states = xcalloc((size_t)task->count + 1, 1);
    for (int64_t i = 0; i < task->count; i++)
        task->states[i] = frame_states_is_missed(states, task->offset + i)
                              ? 'm'
                              : state_letters[frame_states_get(states, task->offset + i)];
}

static void write_head(struct map_task *task, int64_t total)
{
    char *range = frame_range_format(&task->record->queued->frames);

    json_write_begin_object(&task->value);
    json_write_string_member(&task->value, "frames", range);
    json_write_integer_member(&task->value, "total", total);
    json_write_integer_member(&task->value, "offset", task->offset);
    json_write_string_member(&task->value, "states", task->states);
    free(range);
}

enum request_outcome requests_job_frame_map(struct request *request)
{
    struct job_record *record = request_find_job(request);
    struct map_task *task;
    int64_t offset, limit, total;

    if (!record) return REQUEST_FAILED;
    if (!request_read_count(request, "offset", 0, FRAME_COUNT_LIMIT, 0, &offset) ||
        !request_read_count(request, "limit", 1, MAP_LIMIT, MAP_LIMIT, &limit))
        return REQUEST_FAILED;
    total = frame_range_count(&record->queued->frames);
    if (offset > total) offset = total;
    task = xcalloc(1, sizeof *task);
    task->farm = request->farm;
    task->record = record;
    job_record_hold(record);
    task->state_folder = request->farm->options->state_folder;
    task->offset = offset;
    task->count = limit < total - offset ? limit : total - offset;
    copy_states(task);
    write_head(task, total);
    task->answer = request_defer_answer(request, true);
    task->piece = (struct work_piece){.run = on_map_run, .done = on_map_done, .uid = request->client->peer.uid};
    committer_flush(request->farm->committer, on_flushed, task);
    return REQUEST_DEFERRED;
}

static void on_flushed(void *user, bool ok, const struct error *error)
{
    struct map_task *task = user;

    work_desk_put(task->farm->work, &task->piece);
}

static bool on_frame_row(void *user, const struct store_frame *row, struct error *error)
{
    struct map_task *task = user;
    int64_t i = row->index - task->offset;
    char state = task->states[i];

    // The row of a frame that was queued again is outdated; a skipped frame took no time.
    if (state == 's' || state == 'm') task->frames[i].seconds = (float)(row->render_s + row->audit_s + row->encode_s);
    if (state == 's' || state == 'm' || state == 'k') {
        task->frames[i].error = (float)row->accuracy.error;
        task->frames[i].error95 = (float)row->accuracy.error95;
    }
    return true;
}

static void write_short(struct json_writer *writer, float number)
{
    char text[24];
    int length = snprintf(text, sizeof text, "%.4g", (double)number);

    if (number > 0)
        json_write_raw(writer, text, (size_t)length);
    else
        json_write_null(writer);
}

// `offset` is that of a float in a frame.
static void write_numbers(struct map_task *task, const char *key, size_t offset)
{
    json_write_key(&task->value, key);
    json_write_begin_array(&task->value);
    for (int64_t i = 0; i < task->count; i++)
        write_short(&task->value, *(const float *)((const char *)&task->frames[i] + offset));
    json_write_end_array(&task->value);
}

static void write_map(struct map_task *task)
{
    write_numbers(task, "seconds", offsetof(struct map_frame, seconds));
    write_numbers(task, "errors", offsetof(struct map_frame, error));
    write_numbers(task, "errors95", offsetof(struct map_frame, error95));
    json_write_end_object(&task->value);
}

static void on_map_run(struct work_piece *piece)
{
    struct map_task *task = (struct map_task *)piece;
    struct store_reader *reader = store_reader_open(task->state_folder, &task->error);

    if (!reader) return;
    task->frames = xcalloc((size_t)task->count + 1, sizeof task->frames[0]);
    task->ok = task->count == 0 ||
               store_read_frames(reader, task->record->id, (int32_t)task->offset,
                                 (int32_t)(task->offset + task->count - 1), on_frame_row, task, &task->error);
    store_reader_close(reader);
    if (task->ok) write_map(task);
}

static void on_map_done(struct work_piece *piece, bool was_run)
{
    struct map_task *task = (struct map_task *)piece;

    if (!was_run) error_set(&task->error, "the daemon stops: ask the next one");
    if (task->ok)
        answer_send_result(task->answer, &task->value);
    else
        answer_send_error(task->answer, MESSAGE_CODE_INTERNAL, task->error.message);
    job_record_release(task->record);
    json_writer_finish(&task->value);
    free(task->states);
    free(task->frames);
    free(task);
}
