#include "daemon/job_change.h"

#include "core/alloc.h"
#include "core/error.h"
#include "core/json_write.h"
#include "core/log.h"
#include "daemon/committer.h"
#include "daemon/farm.h"
#include "daemon/requests.h"
#include "daemon/worker_pool.h"

#include <stdlib.h>

struct job_retry {
    struct farm *farm;         // borrowed; outlives us
    struct job_record *record; // borrowed; outlives us
    unsigned states;
    struct frame_range range; // owned; empty: all
    struct answer *answer;    // owned
    int64_t retried;
    struct job_retry *next; // on the farm's list of waiting retries
};

static void log_change(const struct job_record *record, const char *what)
{
    struct log_subject subject = job_record_subject(record);

    log_about(LOG_INFO, &subject, "job %lld (\"%s\"): %s", (long long)record->id, record->name, what);
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
    farm_note_change(farm, record);
}

void job_change_resume(struct farm *farm, struct job_record *record)
{
    if (!record->queued->is_paused) return;
    queue_resume(farm->queue, record->queued);
    job_record_set_reason(record, NULL);
    log_change(record, "resumed");
    farm_want_feed(farm);
    farm_note_change(farm, record);
}

void job_change_cancel(struct farm *farm, struct job_record *record, const char *user)
{
    if (!queue_job_is_live(record->queued)) return;
    queue_cancel(farm->queue, record->queued);
    set_reason_by(record, "canceled", user);
    worker_pool_drop_job(farm->pool, record->id, true);
    farm_want_feed(farm);
    farm_note_change(farm, record);
}

void job_change_set_priority(struct farm *farm, struct job_record *record, int priority)
{
    queue_set_priority(farm->queue, record->queued, priority);
    farm_want_feed(farm);
    farm_note_change(farm, record);
}

static void finish_retry(struct job_retry *retry)
{
    frame_range_finish(&retry->range);
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

// The ascending `indices` without the ascending `others`, in place.
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

// Frames that have no row because the whole job was canceled or failed keep their state when the job lives again.
static void add_mark(const struct queue_job *queued, enum frame_state state, const struct store_op *reset,
                     struct store_op *op)
{
    int32_t *indices;
    size_t count = queue_find_frames(queued, 1U << state, NULL, &indices);

    count = subtract(indices, count, reset->reset.indices, reset->reset.count);
    *op = (struct store_op){.kind = STORE_MARK_FRAMES,
                            .mark = {.job = queued->id, .state = state, .indices = indices, .count = count}};
}

static void revive(struct job_record *record)
{
    record->is_ending = record->is_settled = false;
    record->finished_ms = 0;
    if (!record->queued->has_started) record->started_ms = 0;
    if (!record->queued->is_paused) job_record_set_reason(record, NULL);
}

static void run_retry(struct job_retry *retry)
{
    struct farm *farm = retry->farm;
    struct job_record *record = retry->record;
    struct queue_job *queued = record->queued;
    const struct frame_range *range = frame_range_count(&retry->range) > 0 ? &retry->range : NULL;
    struct store_op ops[4] = {{.kind = STORE_RESET_FRAMES, .reset = {.job = record->id}}};
    size_t op_count = 1;

    ops[0].reset.count = queue_find_frames(queued, retry->states, range, &ops[0].reset.indices);
    if (ops[0].reset.count > 0 && queued->is_canceled) add_mark(queued, FRAME_CANCELED, &ops[0], &ops[op_count++]);
    if (ops[0].reset.count > 0 && queued->is_failed) add_mark(queued, FRAME_FAILED, &ops[0], &ops[op_count++]);
    retry->retried = queue_retry(farm->queue, queued, retry->states, range);
    if (retry->retried > 0) {
        log_change(record, "frames of it are queued again");
        revive(record);
    }
    ops[op_count++] = job_record_format_op(record);
    committer_put(farm->committer, COMMIT_REPORTED, ops, op_count, on_retry_committed, retry);
    farm_want_feed(farm);
    farm_note_change(farm, record);
}

void job_change_retry(struct farm *farm, struct job_record *record, unsigned states, struct frame_range *range,
                      struct answer *answer)
{
    struct job_retry *retry = xcalloc(1, sizeof *retry);

    *retry = (struct job_retry){.farm = farm, .record = record, .states = states, .range = *range, .answer = answer};
    *range = (struct frame_range){0};
    if (record->is_sweeping) {
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

    record->is_retry_waiting = false;
    while (*link) {
        struct job_retry *retry = *link;

        if (retry->record != record) {
            link = &retry->next;
            continue;
        }
        *link = retry->next;
        run_retry(retry);
    }
}
