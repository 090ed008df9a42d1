// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/job_change.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/limits.h"
#include "daemon/jobs/job_life.h"
#include "daemon/jobs/root_life.h"
#include "daemon/schedule/queue_search.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_reader.h"
#include "daemon/workers/worker_pool.h"

#include <stdlib.h>
#include <string.h>

// Rows of frames that a retry leaves as they are: so many in one commit take some 50 ms.
enum { MARKS_OF_A_COMMIT = 20 * 1000 };

struct job_retry {
    struct farm *farm;         // borrowed; outlives us
    struct job_record *record; // borrowed; outlives us
    unsigned states;
    struct frame_range range; // owned; empty: all frames
    struct answer *answer;    // owned
    char *user;               // owned; names the client
    bool is_forced, by_admin; // as in struct job_retry_params
    int64_t retried;
    int32_t *marks; // owned; frames that get a row before those of the retry are queued
    size_t mark_count, marked;
    enum frame_state mark_state;
    bool is_listed;         // `marks` has been filled
    struct job_retry *next; // on the farm's list of waiting retries
};

static void on_marked(void *user, bool ok, const struct error *error);
static void run_retry(struct job_retry *retry);

static void log_change(const struct job_record *record, const char *what)
{
    struct log_subject subject = job_record_subject(record);

    log_about(LOG_INFO, &subject, "job %lld (\"%s\"): %s", (long long)record->id, record->name, what);
}

static void log_change_by(const struct job_record *record, const char *what, const char *user)
{
    char *text = xasprintf("%s by %s", what, user);

    log_change(record, text);
    free(text);
}

static void set_reason_by(struct job_record *record, const char *what, const char *user)
{
    char *reason = xasprintf("%s by %s", what, user);

    job_record_set_reason(record, reason);
    log_change(record, reason);
    free(reason);
}

void job_change_pause(struct farm *farm, struct job_record *record, const char *user)
{
    if (record->queued->is_paused) return;
    queue_pause(farm->queue, record->queued);
    set_reason_by(record, "paused", user);
    worker_pool_drop_job(farm->pool, record->id, false);
    job_life_note_change(farm, record);
}

void job_change_resume(struct farm *farm, struct job_record *record, const char *user)
{
    if (!record->queued->is_paused) return;
    queue_resume(farm->queue, record->queued);
    job_record_set_reason(record, NULL);
    log_change_by(record, "resumed", user);
    root_life_check(farm, record, ROOT_LIFE_FOLDER_WANTED, NULL);
    farm_want_feed(farm);
    job_life_note_change(farm, record);
}

void job_change_cancel(struct farm *farm, struct job_record *record, const char *user)
{
    if (!queue_job_is_live(record->queued)) return;
    queue_cancel(farm->queue, record->queued);
    set_reason_by(record, "canceled", user);
    worker_pool_drop_job(farm->pool, record->id, true);
    farm_want_feed(farm);
    job_life_note_change(farm, record);
}

void job_change_set_priority(struct farm *farm, struct job_record *record, int priority, const char *user)
{
    char *what = xasprintf("priority %d, before %d, set", priority, record->queued->priority);

    log_change_by(record, what, user);
    free(what);
    queue_set_priority(farm->queue, record->queued, priority);
    farm_want_feed(farm);
    job_life_note_change(farm, record);
}

static void finish_retry(struct job_retry *retry)
{
    frame_range_finish(&retry->range);
    free(retry->marks);
    free(retry->user);
    free(retry);
}

static void on_retry_committed(void *user, bool ok, const struct error *error)
{
    struct job_retry *retry = user;
    struct json_writer value = {0};

    if (ok) {
        json_write_begin_object(&value);
        json_write_integer_member(&value, "retried", retry->retried);
        json_write_end_object(&value);
        answer_send_result(retry->answer, &value);
        json_writer_finish(&value);
    } else {
        answer_send_error(retry->answer, MESSAGE_CODE_STORE, error->message);
    }
    finish_retry(retry);
}

// Removes `others` from `indices` in place; both ascend. Returns the new count.
static size_t subtract(int32_t *indices, size_t count, const int32_t *others, size_t other_count)
{
    size_t kept = 0, other = 0;

    for (size_t i = 0; i < count; i++) {
        while (other < other_count && others[other] < indices[i])
            other++;
        if (other == other_count || others[other] != indices[i]) indices[kept++] = indices[i];
    }
    return kept;
}

// Lists the frames that a retry leaves as they are: a canceled or failed job has no rows for them.
static void list_marks(struct job_retry *retry, const struct store_op *reset)
{
    const struct queue_job *queued = retry->record->queued;

    retry->is_listed = true;
    if (reset->reset.count == 0 || (!queued->is_canceled && !queued->is_failed)) return;
    retry->mark_state = queued->is_failed ? FRAME_FAILED : FRAME_CANCELED;
    retry->mark_count = queue_search_frames(queued, 1U << retry->mark_state, NULL, &retry->marks);
    retry->mark_count = subtract(retry->marks, retry->mark_count, reset->reset.indices, reset->reset.count);
}

// Stores the state of the next of these frames. The job stays as it is until all have their rows, so that a crash
// before that changes nothing, and commits of others go between.
static void put_marks(struct job_retry *retry)
{
    size_t left = retry->mark_count - retry->marked, count = left < MARKS_OF_A_COMMIT ? left : MARKS_OF_A_COMMIT;
    struct store_op op = {
        .kind = STORE_MARK_FRAMES,
        .mark = {.job = retry->record->id, .state = (int)retry->mark_state, .count = count},
    };

    op.mark.indices = xmalloc(count * sizeof op.mark.indices[0]);
    memcpy(op.mark.indices, retry->marks + retry->marked, count * sizeof op.mark.indices[0]);
    retry->marked += count;
    retry->record->is_retry_waiting = retry->record->is_marking = true;
    committer_put(retry->farm->committer, COMMIT_CERTAIN, &op, 1, on_marked, retry);
}

static void on_marked(void *user, bool ok, const struct error *error)
{
    struct job_retry *retry = user;
    struct job_record *record = retry->record;
    struct farm *farm = retry->farm;

    if (retry->marked < retry->mark_count) {
        put_marks(retry);
        return;
    }
    record->is_marking = false;
    run_retry(retry);
    job_change_retry_waiting(farm, record);
}

// Forces the frames of `reset`, which are queued, and returns the op that stores that.
static struct store_op force(struct queue_job *queued, const struct store_op *reset)
{
    size_t count = reset->reset.count;
    struct store_op op = {.kind = STORE_MARK_FRAMES,
                          .mark = {.job = queued->id, .state = FRAME_QUEUED, .count = count}};

    op.mark.indices = xmalloc((count + 1) * sizeof op.mark.indices[0]);
    for (size_t i = 0; i < count; i++) {
        op.mark.indices[i] = reset->reset.indices[i];
        queue_force_frame(queued, op.mark.indices[i]);
    }
    return op;
}

static void revive(struct job_record *record)
{
    record->is_ending = record->is_swept = false;
    record->finished_ms = 0;
    if (!record->queued->has_started) record->started_ms = 0;
    if (!record->queued->is_paused) job_record_set_reason(record, NULL);
}

// Files of frames that are rendered again leave the disk count, which they join again when they are published.
static void uncount_files(struct farm *farm, struct job_record *record, const int32_t *indices, size_t count)
{
    const struct queue_frame *states = record->queued->states;
    int64_t bytes, sum = 0;

    for (size_t first = 0, next; first < count; first = next) {
        next = first + 1;
        if (states[indices[first]].state != FRAME_SUCCEEDED) continue;
        while (next < count && indices[next] == indices[next - 1] + 1 && states[indices[next]].state == FRAME_SUCCEEDED)
            next++;
        if (store_read_bytes(farm->reader, record->id, indices[first], indices[next - 1], &bytes, NULL)) sum += bytes;
    }
    record->disk_bytes = sum < record->disk_bytes ? record->disk_bytes - sum : 0;
}

static void run_retry(struct job_retry *retry)
{
    struct farm *farm = retry->farm;
    struct job_record *record = retry->record;
    struct queue_job *queued = record->queued;
    const struct frame_range *range = frame_range_count(&retry->range) > 0 ? &retry->range : NULL;
    struct store_op ops[5] = {{.kind = STORE_RESET_FRAMES, .reset = {.job = record->id}}};
    size_t op_count = 1;
    struct error error;

    ops[0].reset.count = queue_search_frames(queued, retry->states, range, &ops[0].reset.indices);
    if (!limits_check_retry(farm, record, (int64_t)ops[0].reset.count, retry->by_admin, &error)) {
        answer_send_error(retry->answer, MESSAGE_CODE_NOT_ALLOWED, error.message);
        store_op_finish(&ops[0]);
        finish_retry(retry);
        return;
    }
    if (!retry->is_listed) list_marks(retry, &ops[0]);
    if (retry->marked < retry->mark_count) {
        store_op_finish(&ops[0]);
        put_marks(retry);
        return;
    }
    uncount_files(farm, record, ops[0].reset.indices, ops[0].reset.count);
    retry->retried = (int64_t)ops[0].reset.count;
    queue_retry(farm->queue, queued, ops[0].reset.indices, ops[0].reset.count);
    if (retry->retried > 0 && retry->is_forced) ops[op_count++] = force(queued, &ops[0]);
    if (retry->retried > 0) {
        log_change_by(record, "frames of it are queued again", retry->user);
        revive(record);
    }
    root_life_check(farm, record, ROOT_LIFE_FOLDER_WANTED, NULL);
    ops[op_count++] = job_record_format_op(record);
    committer_put(farm->committer, COMMIT_REPORTED, ops, op_count, on_retry_committed, retry);
    farm_want_feed(farm);
    job_life_note_change(farm, record);
}

void job_change_retry(struct farm *farm, struct job_record *record, const struct job_retry_params *params)
{
    struct job_retry *retry = xcalloc(1, sizeof *retry);

    *retry = (struct job_retry){.farm = farm,
                                .record = record,
                                .states = params->states,
                                .range = params->range,
                                .is_forced = params->is_forced,
                                .user = xstrdup(params->user),
                                .by_admin = params->by_admin,
                                .answer = params->answer};
    if (record->is_sweeping || record->is_marking) {
        record->is_retry_waiting = true;
        retry->next = farm->waiting_retries;
        farm->waiting_retries = retry;
    } else {
        run_retry(retry);
    }
}

void job_change_retry_waiting(struct farm *farm, struct job_record *record)
{
    struct job_retry **link = &farm->waiting_retries;

    record->is_retry_waiting = record->is_marking;
    while (*link) {
        struct job_retry *retry = *link;

        if (retry->record != record || record->is_marking) {
            link = &retry->next;
            continue;
        }
        *link = retry->next;
        run_retry(retry);
        if (record->is_marking) return;
    }
}
