// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/job_delete.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/limits.h"
#include "daemon/jobs/after_desk.h"
#include "daemon/jobs/delete_parts.h"
#include "daemon/jobs/events.h"
#include "daemon/output/file_remover.h"
#include "daemon/output/output_claims.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"

#include <stdlib.h>
#include <string.h>

struct job_delete {
    struct farm *farm;          // borrowed; outlives us
    struct job_record *record;  // borrowed until it is removed here
    struct answer *answer;      // owned; NULL: nobody waits
    void (*on_end)(void *user); // may be NULL
    void *end_user;
    char *user; // owned; names the client
    uv_work_t work;
    bool with_files, has_begun;
    struct file_remover remover;
    bool ok;
    struct error error;
    struct output_claim claim; // of its files, with `with_files`
    struct delete_parts parts;
    struct job_delete *next; // on the farm's list of deletions
};

static void on_flushed(void *user, bool ok, const struct error *error);
static void on_files_run(uv_work_t *work);
static void on_files_done(uv_work_t *work, int status);
static void on_committed(void *user, bool ok, const struct error *error);

static bool is_ready(const struct job_record *record)
{
    return record->is_swept && !record->is_sweeping && record->frames_in_flight == 0;
}

static void begin(struct job_delete *deletion)
{
    deletion->has_begun = true;
    committer_flush(deletion->farm->committer, on_flushed, deletion);
}

void job_delete_go_on(struct farm *farm)
{
    struct job_delete *ready = NULL;

    for (struct job_delete *deletion = farm->deletions; deletion; deletion = deletion->next) {
        if (deletion->has_begun) return;
        if (!ready && is_ready(deletion->record)) ready = deletion;
    }
    if (ready) begin(ready);
}

void job_delete_start(struct farm *farm, struct job_record *record, const struct job_delete_params *params)
{
    struct job_delete *deletion = xcalloc(1, sizeof *deletion), **link = &farm->deletions;

    *deletion = (struct job_delete){.farm = farm,
                                    .record = record,
                                    .with_files = params->with_files,
                                    .answer = params->answer,
                                    .on_end = params->on_end,
                                    .end_user = params->end_user,
                                    .user = xstrdup(params->user)};
    deletion->work.data = deletion;
    record->is_deleting = true;
    if (params->with_files) {
        deletion->claim = (struct output_claim){.files = job_record_files(record), .removed = record};
        output_claims_add(farm, &deletion->claim);
    }
    while (*link)
        link = &(*link)->next;
    *link = deletion;
    job_delete_go_on(farm);
}

static void end(struct job_delete *deletion)
{
    struct farm *farm = deletion->farm;
    struct job_delete **link = &farm->deletions;

    while (*link != deletion)
        link = &(*link)->next;
    *link = deletion->next;
    if (deletion->with_files) output_claims_remove(farm, &deletion->claim);
    if (deletion->on_end) deletion->on_end(deletion->end_user);
    free(deletion->user);
    free(deletion);
    job_delete_go_on(farm);
}

// The job stays, without the files that were removed.
static void give_up(struct job_delete *deletion, enum message_code code, const struct error *error)
{
    struct job_record *record = deletion->record;

    record->is_deleting = false;
    record->disk_bytes -= deletion->remover.removed_bytes;
    if (record->disk_bytes < 0) record->disk_bytes = 0;
    limits_count_job(deletion->farm, record);
    if (deletion->answer) answer_send_error(deletion->answer, code, error->message);
    end(deletion);
}

// What has begun is brought to its end.
static void commit(struct job_delete *deletion)
{
    enum commit_policy policy = deletion->parts.has_begun ? COMMIT_CERTAIN : COMMIT_OR_DROP;
    struct store_op op = delete_parts_take(&deletion->parts, deletion->record, deletion->user);

    committer_put(deletion->farm->committer, policy, &op, 1, on_committed, deletion);
}

// What the store says of the job until its end.
static void note_begun(struct job_delete *deletion)
{
    char *reason = delete_parts_format_reason(deletion->record, deletion->user);

    queue_restore_end(deletion->record->queued, true, false);
    job_record_set_reason(deletion->record, reason);
    free(reason);
}

static bool is_used(const struct farm *farm, const struct job_record *record)
{
    const struct job_files files = job_record_files(record);

    for (size_t i = 0; i < farm->jobs.count; i++) {
        const struct job_record *other = farm->jobs.records[i];

        if (other == record || strcmp(other->path.folder, record->path.folder) != 0) continue;
        if (strcmp(other->root, record->root) != 0) continue;
        if (queue_job_is_live(other->queued) || other->frames_in_flight > 0 || other->is_retry_waiting) return true;
    }
    return output_claims_use_folder(farm, &files);
}

// The rows of all published files are on disk.
static void on_flushed(void *user, bool ok, const struct error *error)
{
    struct job_delete *deletion = user;
    const struct job_record *record = deletion->record;

    if (!ok) {
        give_up(deletion, MESSAGE_CODE_STORE, error);
        return;
    }
    if (!deletion->with_files) {
        commit(deletion);
        return;
    }
    deletion->remover = (struct file_remover){.state_folder = deletion->farm->options->state_folder,
                                              .job = record->id,
                                              .root = record->root,
                                              .root_id = record->output_root->id,
                                              .path = &record->path,
                                              .frames = &record->queued->frames,
                                              .finished_ms = record->finished_ms,
                                              .may_remove_folder = !is_used(deletion->farm, record)};
    uv_queue_work(deletion->farm->loop, &deletion->work, on_files_run, on_files_done);
}

static void on_files_run(uv_work_t *work)
{
    struct job_delete *deletion = work->data;

    deletion->ok = file_remover_run(&deletion->remover, &deletion->error);
}

static void on_files_done(uv_work_t *work, int status)
{
    struct job_delete *deletion = work->data;

    (void)status;
    if (deletion->ok) {
        commit(deletion);
        return;
    }
    error_prefix(&deletion->error, "output");
    give_up(deletion, MESSAGE_CODE_INTERNAL, &deletion->error);
}

static void send_answer(struct job_delete *deletion)
{
    const struct file_remover *remover = &deletion->remover;
    struct json_writer value = {0};

    json_write_begin_object(&value);
    json_write_integer_member(&value, "files_removed", remover->removed);
    json_write_integer_member(&value, "files_kept", remover->kept);
    json_write_integer_member(&value, "files_missing", remover->missing);
    json_write_integer_member(&value, "files_found",
                              deletion->with_files ? deletion->record->queued->states.counts[FRAME_SKIPPED] : 0);
    json_write_end_object(&value);
    answer_send_result(deletion->answer, &value);
    json_writer_finish(&value);
}

static void tell(struct job_delete *deletion)
{
    struct log_subject subject = job_record_subject(deletion->record);

    log_about(LOG_INFO, &subject, "job %lld (\"%s\"): deleted by %s; %lld files removed",
              (long long)deletion->record->id, deletion->record->name, deletion->user,
              (long long)deletion->remover.removed);
    events_send_deleted(deletion->farm->events, deletion->record);
    if (deletion->answer) send_answer(deletion);
}

static void on_committed(void *user, bool ok, const struct error *error)
{
    struct job_delete *deletion = user;
    struct farm *farm = deletion->farm;
    struct job_record *record = deletion->record;

    if (!ok) {
        give_up(deletion, MESSAGE_CODE_STORE, error);
        return;
    }
    if (!deletion->parts.is_last) {
        if (deletion->parts.next == 0) note_begun(deletion);
        commit(deletion);
        return;
    }
    tell(deletion);
    after_desk_forget(farm, record);
    limits_forget_job(record);
    queue_remove_job(farm->queue, record->queued);
    record->queued = NULL;
    job_table_remove(&farm->jobs, record);
    end(deletion);
}
