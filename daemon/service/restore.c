// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/restore.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/job/output_path.h"
#include "core/job/output_root.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/limits.h"
#include "daemon/farm/pool_access.h"
#include "daemon/farm/shares.h"
#include "daemon/farm/token_book.h"
#include "daemon/jobs/after_desk.h"
#include "daemon/jobs/job_life.h"
#include "daemon/jobs/notices.h"
#include "daemon/jobs/root_life.h"
#include "daemon/output/intent.h"
#include "daemon/service/opening.h"
#include "daemon/service/root_settings.h"
#include "daemon/settings/options.h"
#include "daemon/store/store.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct restore_state {
    struct farm *farm;
    struct job_record *record;   // of the latest frame row
    struct store_frame *intents; // owned; rows of frames that were being published
    size_t intent_count, intent_capacity;
    struct store_op *ops; // owned; the results of the intents
    size_t op_count, op_capacity;
};

static char *copy_text(const char *text)
{
    return text ? xstrdup(text) : NULL;
}

// False for a job whose document is damaged or cannot be read: `job` then has one frame, in a file that nothing writes.
static bool read_job(struct job *job, const struct store_job *row, struct error *cause)
{
    if (row->is_document_damaged)
        error_set(cause, "store: its document was damaged on the disk, and no backup has it: submit it again");
    else if (job_parse(job, row->document, strlen(row->document), row->root, cause))
        return true;
    else
        error_prefix(cause, "this marchd cannot read its document");
    job->width_px = job->height_px = 1;
    if (!frame_range_parse(&job->frames, "0", NULL) || !output_path_parse(&job->output.path, "unknown/f.#.exr", NULL))
        abort();
    return false;
}

// The job is shown as failed. Its rows stay unchanged, for a version of the daemon that can read it.
static void note_unreadable(struct job_record *record, const struct error *cause)
{
    struct log_subject subject = job_record_subject(record);

    record->is_unreadable = true;
    record->restored_canceled = false;
    record->restored_failed = record->is_ending = record->is_swept = true;
    if (record->finished_ms == 0) record->finished_ms = record->submitted_ms;
    job_record_set_reason(record, cause->message);
    log_about(LOG_ERROR, &subject, "job %lld: %s", (long long)record->id, cause->message);
}

// Some of its owner, name, priority, state or times may be wrong: a person decides.
static void hold_damaged(struct job_record *record)
{
    record->queued->is_paused = true;
    job_record_set_reason(record, "paused: store: its row was damaged on the disk, and no backup has it: "
                                  "look at it, then resume it or cancel it");
}

static bool on_job(void *user, const struct store_job *row, struct error *error)
{
    struct restore_state *state = user;
    struct farm *farm = state->farm;
    struct job_record *record;
    struct job job = {0};
    struct error cause = {0};
    bool is_readable = read_job(&job, row, &cause);

    record = job_table_add(&farm->jobs, row->id, xstrdup(row->root), &job.output.path);
    record->output_root = root_table_add(&farm->roots, row->root);
    record->name = xstrdup(row->name);
    record->owner = xstrdup(row->owner);
    record->owner_uid = row->owner_uid;
    record->notes = job.notes;
    job.notes = (struct job_notes){0};
    record->notify = job.notify;
    job.notify = (struct job_notify){0};
    record->after = job_after_take(&job.after);
    record->waits = row->waits && record->after.count > 0;
    record->reason = copy_text(row->reason);
    job_paths_list(&record->inputs, &job);
    record->pool = copy_text(job.pool);
    record->code = copy_text(scene_find_code(&job.scene));
    record->submitted_ms = row->submitted_ms;
    record->started_ms = row->started_ms;
    record->finished_ms = llabs(row->finished_ms);
    record->is_ending = record->is_swept = record->is_end_told = row->finished_ms != 0;
    record->needs_sweep = row->finished_ms < 0;
    record->facts = job_facts_of(&job);
    record->has_old_parts = true;
    record->queued = queue_add_job(farm->queue, &(struct queue_job_params){.id = row->id,
                                                                           .owner_uid = row->owner_uid,
                                                                           .frames = &job.frames,
                                                                           .priority = row->priority,
                                                                           .is_paused = row->is_paused,
                                                                           .waits = record->waits,
                                                                           .order = &job.order});
    record->queued->has_started = row->started_ms != 0;
    record->restored_canceled = row->is_canceled;
    record->restored_failed = row->is_failed;
    job_finish(&job);
    if (!is_readable)
        note_unreadable(record, &cause);
    else if (row->is_damaged)
        hold_damaged(record);
    return true;
}

static bool has_file(const struct store_frame *row)
{
    return row->state == FRAME_SUCCEEDED || row->state == FRAME_SKIPPED;
}

static void note_published(struct job_record *record, const struct store_frame *row)
{
    record->disk_bytes += (int64_t)row->size_bytes;
    estimate_add(&record->estimate, row->render_s + row->audit_s);
}

static bool on_frame(void *user, const struct store_frame *row, struct error *error)
{
    struct restore_state *state = user;

    if (!state->record || state->record->id != row->job) state->record = job_table_find(&state->farm->jobs, row->job);
    if (!state->record || state->record->is_unreadable || row->index < 0 ||
        row->index >= frame_range_count(&state->record->queued->frames))
        return true;
    if (row->state != FRAME_RUNNING) {
        queue_restore_frame(state->record->queued, row->index, (enum frame_state)row->state, row->attempts);
        if (row->state == FRAME_QUEUED) queue_force_frame(state->record->queued, row->index);
        if (row->state == FRAME_SUCCEEDED) note_published(state->record, row);
        if (has_file(row)) job_record_note_accuracy(state->record, &row->accuracy);
        if (has_file(row) && frame_accuracy_is_over(&row->accuracy, state->record->facts.tolerance))
            queue_note_missed(state->record->queued, row->index);
        return true;
    }
    state->intents = xgrow(state->intents, &state->intent_capacity, state->intent_count + 1, sizeof *row);
    state->intents[state->intent_count] = *row;
    state->intents[state->intent_count++].error = NULL;
    return true;
}

// Whether the frame is published, which nobody can say while its root is away.
static bool is_published(const struct farm *farm, const struct job_record *record, const struct store_frame *row,
                         bool *is_away)
{
    int folder = output_root_open_folder(&record->path, record->root, record->output_root->id, false, NULL);
    bool ok = folder >= 0 && intent_settle(record, row, farm->id, folder);

    *is_away = folder == OUTPUT_ROOT_AWAY;
    if (folder >= 0) close(folder);
    return ok;
}

static void on_op(void *user, struct store_op op)
{
    struct restore_state *state = user;

    state->ops = xgrow(state->ops, &state->op_capacity, state->op_count + 1, sizeof op);
    state->ops[state->op_count++] = op;
}

static void finish_publish(struct restore_state *state, const struct store_frame *row)
{
    struct job_record *record = job_table_find(&state->farm->jobs, row->job);
    bool is_away, is_done = is_published(state->farm, record, row, &is_away);
    struct store_op op = {.kind = STORE_SET_FRAME, .frame = *row};
    struct log_subject subject = job_record_subject(record);

    queue_restore_frame(record->queued, row->index, is_done ? FRAME_SUCCEEDED : FRAME_QUEUED, row->attempts);
    if (is_away) {
        job_record_keep_intent(record, row);
        return;
    }
    if (is_done) {
        note_published(record, row);
        if (frame_accuracy_is_over(&row->accuracy, record->facts.tolerance))
            queue_note_missed(record->queued, row->index);
        op.frame.state = FRAME_SUCCEEDED;
    } else {
        op = store_op_reset_frame(row->job, row->index);
    }
    on_op(state, op);
    subject.frame = frame_range_at(&record->queued->frames, row->index);
    subject.attempt = row->attempts;
    log_about(LOG_INFO, &subject, "job %lld frame %d: its file was being published when the daemon ended: now %s",
              (long long)row->job, subject.frame, is_done ? "published" : "queued again");
}

// A job that was canceled or failed as a whole has no rows for the frames that ended with it.
static void restore_ends(struct farm *farm)
{
    for (size_t i = 0; i < farm->jobs.count; i++) {
        struct job_record *record = farm->jobs.records[i];

        queue_restore_end(record->queued, record->restored_canceled, record->restored_failed);
        root_life_note_job(farm, record);
        if (record->waits) after_desk_add(farm, record);
        record->sent_state = queue_job_state(record->queued);
        limits_count_job(farm, record);
    }
}

bool restore_farm(struct farm *farm, struct store *store, struct error *error)
{
    struct restore_state state = {.farm = farm};
    bool ok = shares_restore(farm, error) && token_book_restore(farm, error) && root_settings_load(farm, error) &&
              store_load(store, on_job, on_frame, &state, error);

    if (ok) root_settings_take(farm, &farm->options->output_roots, on_op, &state);
    if (ok) root_settings_tell_inputs(&farm->options->input_roots);
    for (size_t i = 0; i < state.intent_count && ok; i++)
        finish_publish(&state, &state.intents[i]);
    if (ok && state.op_count > 0)
        ok = opening_commit(store, farm->options->state_folder, state.ops, state.op_count, error);
    restore_ends(farm);
    limits_refresh(farm);
    pool_access_refresh(farm);
    shares_refresh(farm);
    for (size_t i = 0; i < state.op_count; i++)
        store_op_finish(&state.ops[i]);
    free(state.ops);
    free(state.intents);
    farm->epoch = store_epoch(store);
    farm->next_job_id = store_next_job_id(store);
    farm->next_plan_number = store_next_plan_number(store);
    return ok && notices_restore(farm, error);
}

void restore_end_jobs(struct farm *farm)
{
    for (size_t i = 0; i < farm->jobs.count; i++) {
        struct job_record *record = farm->jobs.records[i];

        if (!queue_job_is_live(record->queued) && !record->is_swept) job_life_note_change(farm, record);
        root_life_sweep_again(farm, record);
    }
}
