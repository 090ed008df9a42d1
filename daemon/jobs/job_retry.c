// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/job_retry.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/limits.h"
#include "daemon/jobs/job_life.h"
#include "daemon/jobs/notice_watch.h"
#include "daemon/jobs/root_life.h"
#include "daemon/loop/work_desk.h"
#include "daemon/schedule/queue_search.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_marks.h"
#include "daemon/store/store_reader.h"

#include <stdlib.h>

// A commit that deletes 20,000 rows takes some 50 ms. They are looked for in so many frames at a time.
enum { ROWS_OF_A_PART = 20 * 1000, FRAMES_OF_A_LOOK = 16 * 1024 };

struct job_retry {
    struct work_piece piece;
    struct farm *farm;         // borrowed; outlives us
    struct job_record *record; // borrowed; outlives us
    struct answer *answer;     // owned
    unsigned states;
    char *range, *user;       // owned; as in struct job_retry_params
    bool is_forced, by_admin; // likewise
    struct frame_set numbers; // owned; of the range
    struct frame_set frames;  // owned; their indices
    int64_t first, end;       // the part that is next: frames of these indices
    int32_t *rows;            // owned; those of them that have rows
    size_t row_count, row_capacity;
    int64_t file_bytes; // of their files
    int64_t retried;
    bool has_begun, ok;
    struct error error;
    struct job_retry *next; // on the farm's list of waiting retries
};

static void on_range_run(struct work_piece *piece);
static void on_range_done(struct work_piece *piece, bool was_run);
static void on_flushed(void *user, bool ok, const struct error *error);
static void on_rows_run(struct work_piece *piece);
static void on_rows_done(struct work_piece *piece, bool was_run);
static void on_committed(void *user, bool ok, const struct error *error);

static void put_piece(struct job_retry *retry, void (*run)(struct work_piece *piece),
                      void (*done)(struct work_piece *piece, bool was_run))
{
    retry->piece.run = run;
    retry->piece.done = done;
    retry->piece.goes_on = done == on_rows_done;
    work_desk_put(retry->farm->work, &retry->piece);
}

static void begin(struct job_retry *retry)
{
    retry->has_begun = true;
    retry->record->is_retrying = retry->record->is_retry_waiting = true;
    put_piece(retry, on_range_run, on_range_done);
}

static void wait_in_line(struct job_retry *retry)
{
    struct job_retry **link = &retry->farm->waiting_retries;

    retry->record->is_retry_waiting = true;
    while (*link)
        link = &(*link)->next;
    retry->next = NULL;
    *link = retry;
}

static void finish(struct job_retry *retry)
{
    struct farm *farm = retry->farm;
    struct job_record *record = retry->record;

    frame_set_finish(&retry->numbers);
    frame_set_finish(&retry->frames);
    free(retry->range);
    free(retry->rows);
    free(retry->user);
    free(retry);
    record->is_retrying = false;
    job_retry_go_on(farm, record);
}

static void fail(struct job_retry *retry, enum message_code code, const char *text)
{
    answer_send_error(retry->answer, code, text);
    finish(retry);
}

static void succeed(struct job_retry *retry)
{
    struct json_writer value = {0};

    json_write_begin_object(&value);
    json_write_integer_member(&value, "retried", retry->retried);
    json_write_end_object(&value);
    answer_send_result(retry->answer, &value);
    json_writer_finish(&value);
    finish(retry);
}

static void on_range_run(struct work_piece *piece)
{
    struct job_retry *retry = (struct job_retry *)piece;

    retry->ok = !retry->range || frame_set_parse(&retry->numbers, retry->range, &retry->error);
    if (!retry->ok) error_prefix(&retry->error, "params.range");
}

// The frames are known; none of them changes until it is queued. The flush brings their rows to disk.
static void on_range_done(struct work_piece *piece, bool was_run)
{
    struct job_retry *retry = (struct job_retry *)piece;

    if (!was_run) {
        fail(retry, MESSAGE_CODE_INTERNAL, "the daemon stops: ask the next one");
    } else if (!retry->ok) {
        fail(retry, MESSAGE_CODE_PARAMS, retry->error.message);
    } else {
        queue_search_frames(retry->record->queued, retry->states, retry->range ? &retry->numbers : NULL,
                            &retry->frames);
        committer_flush(retry->farm->committer, on_flushed, retry);
    }
}

static void on_flushed(void *user, bool ok, const struct error *error)
{
    struct job_retry *retry = user;

    if (ok)
        put_piece(retry, on_rows_run, on_rows_done);
    else
        fail(retry, MESSAGE_CODE_STORE, error->message);
}

static bool on_row(void *user, const struct store_frame *row, struct error *error)
{
    struct job_retry *retry = user;

    if (!frame_set_has(&retry->frames, row->index)) return true;
    retry->rows = xgrow(retry->rows, &retry->row_capacity, retry->row_count + 1, sizeof retry->rows[0]);
    retry->rows[retry->row_count++] = row->index;
    if (row->state == FRAME_SUCCEEDED) retry->file_bytes += (int64_t)row->size_bytes;
    return true;
}

// Frames without rows cost nothing: they belong to the part, however many they are.
static void on_rows_run(struct work_piece *piece)
{
    struct job_retry *retry = (struct job_retry *)piece;
    struct store_reader *reader = store_reader_open(retry->farm->options->state_folder, &retry->error);

    retry->ok = reader != NULL;
    retry->row_count = 0;
    retry->file_bytes = 0;
    retry->end = retry->first;
    while (retry->ok && retry->end < retry->frames.limit && retry->row_count < ROWS_OF_A_PART) {
        int64_t end = retry->end + FRAMES_OF_A_LOOK;

        if (end > retry->frames.limit) end = retry->frames.limit;
        retry->ok = store_read_frames(reader, retry->record->id, (int32_t)retry->end, (int32_t)(end - 1), on_row, retry,
                                      &retry->error);
        retry->end = end;
    }
    store_reader_close(reader);
}

static void log_retry(const struct job_retry *retry)
{
    struct log_subject subject = job_record_subject(retry->record);

    log_about(LOG_INFO, &subject, "job %lld (\"%s\"): frames of it are queued again by %s",
              (long long)retry->record->id, retry->record->name, retry->user);
}

static void revive(struct job_record *record)
{
    record->is_ending = record->is_swept = record->is_end_told = false;
    record->finished_ms = 0;
    if (!record->queued->has_started) record->started_ms = 0;
    if (!record->queued->is_paused) job_record_set_reason(record, NULL);
}

// Files of frames that are rendered again leave the disk count, which they join again when they are published.
static void uncount_files(struct job_retry *retry)
{
    int64_t left = retry->record->disk_bytes - retry->file_bytes;

    retry->record->disk_bytes = left > 0 ? left : 0;
}

// Queues the part. Rows, marks and the job are one commit: a crash leaves all of the part as it was or none.
static void queue_part(struct job_retry *retry)
{
    struct farm *farm = retry->farm;
    struct job_record *record = retry->record;
    struct store_op ops[3] = {{.kind = STORE_RESET_FRAMES, .reset = {.job = record->id}}};
    int64_t queued = queue_retry(record->queued, &retry->frames, retry->first, retry->end, retry->is_forced);

    uncount_files(retry);
    if (queued > 0 && retry->retried == 0) log_retry(retry);
    if (queued > 0) revive(record);
    notice_watch_look(farm, record);
    retry->retried += queued;
    retry->first = retry->end;
    ops[0].reset.indices = retry->rows;
    ops[0].reset.count = retry->row_count;
    retry->rows = NULL;
    retry->row_capacity = 0;
    root_life_check(farm, record, ROOT_LIFE_FOLDER_WANTED, NULL);
    ops[1] = store_marks_format_op(record->queued);
    ops[2] = job_record_format_op(record);
    committer_put(farm->committer, COMMIT_REPORTED, ops, 3, on_committed, retry);
    farm_want_feed(farm);
    job_life_note_change(farm, record);
}

static void go_on(struct job_retry *retry)
{
    const struct queue_job *queued = retry->record->queued;
    int64_t left = frame_set_count_from(&retry->frames, retry->first);

    if (retry->record->is_sweeping)
        wait_in_line(retry); // it ended before its next part
    else if (retry->retried > 0 && (left == 0 || queued->is_canceled || queued->is_failed))
        succeed(retry);
    else if (!limits_check_retry(retry->farm, retry->record, left, retry->by_admin, &retry->error))
        fail(retry, MESSAGE_CODE_NOT_ALLOWED, retry->error.message);
    else
        queue_part(retry);
}

static void on_rows_done(struct work_piece *piece, bool was_run)
{
    struct job_retry *retry = (struct job_retry *)piece;

    if (!was_run)
        fail(retry, MESSAGE_CODE_INTERNAL, "the daemon stops: ask the next one");
    else if (!retry->ok)
        fail(retry, MESSAGE_CODE_INTERNAL, retry->error.message);
    else
        go_on(retry);
}

static void on_committed(void *user, bool ok, const struct error *error)
{
    struct job_retry *retry = user;

    if (!ok)
        fail(retry, MESSAGE_CODE_STORE, error->message);
    else if (retry->first < retry->frames.limit)
        put_piece(retry, on_rows_run, on_rows_done);
    else
        succeed(retry);
}

void job_retry_start(struct farm *farm, struct job_record *record, const struct job_retry_params *params)
{
    struct job_retry *retry = xcalloc(1, sizeof *retry);

    *retry = (struct job_retry){.piece.uid = record->owner_uid,
                                .farm = farm,
                                .record = record,
                                .states = params->states,
                                .range = params->range ? xstrdup(params->range) : NULL,
                                .is_forced = params->is_forced,
                                .user = xstrdup(params->user),
                                .by_admin = params->by_admin,
                                .answer = params->answer};
    if (record->is_sweeping || record->is_retrying)
        wait_in_line(retry);
    else
        begin(retry);
}

// Of those that wait for the job, one that has begun is the next.
static struct job_retry *leave_line(struct farm *farm, const struct job_record *record)
{
    for (struct job_retry **link = &farm->waiting_retries; *link; link = &(*link)->next) {
        struct job_retry *retry = *link;

        if (retry->record != record || (record->is_retrying && !retry->has_begun)) continue;
        *link = retry->next;
        return retry;
    }
    return NULL;
}

void job_retry_go_on(struct farm *farm, struct job_record *record)
{
    struct job_retry *retry = record->is_sweeping ? NULL : leave_line(farm, record);

    if (retry && retry->has_begun)
        go_on(retry);
    else if (retry)
        begin(retry);
    else if (!record->is_sweeping)
        record->is_retry_waiting = record->is_retrying;
}
