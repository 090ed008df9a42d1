// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/job/frame_set.h"
#include "core/job/job.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/limits.h"
#include "daemon/jobs/job_change.h"
#include "daemon/jobs/job_delete.h"
#include "daemon/jobs/job_etas.h"
#include "daemon/jobs/job_retry.h"
#include "daemon/jobs/job_view.h"
#include "daemon/output/output_claims.h"
#include "daemon/requests/job_submit.h"
#include "daemon/store/committer.h"

#include <stdlib.h>

// A change whose answer, the job, is sent when the change is on disk.
struct pending_change {
    struct farm *farm;         // borrowed; outlives us
    struct answer *answer;     // owned
    struct job_record *record; // borrowed; outlives us
};

static void on_change_committed(void *user, bool ok, const struct error *error)
{
    struct pending_change *change = user;
    struct json_writer value = {0};
    struct job_etas etas = {0};

    if (ok) {
        job_view_write(change->farm, &etas, change->record, &value);
        job_etas_finish(&etas);
        answer_send_result(change->answer, &value);
        json_writer_finish(&value);
    } else {
        answer_send_error(change->answer, MESSAGE_CODE_STORE, error->message);
    }
    free(change);
}

static enum request_outcome commit_change(struct request *request, struct job_record *record)
{
    struct pending_change *change = xmalloc(sizeof *change);
    struct store_op op = job_record_format_op(record);

    *change = (struct pending_change){
        .farm = request->farm, .record = record, .answer = request_defer_answer(request, false)};
    committer_put(request->farm->committer, COMMIT_REPORTED, &op, 1, on_change_committed, change);
    return REQUEST_DEFERRED;
}

// A live job that the client may change. NULL, with the failure filled: none.
static struct job_record *find_live_job(struct request *request)
{
    struct job_record *record = request_find_own_job(request);

    if (!record || queue_job_is_live(record->queued)) return record;
    request_fail(request, MESSAGE_CODE_CONFLICT, "job %lld is over: it %s", (long long)record->id,
                 queue_job_state(record->queued) == JOB_CANCELED ? "was canceled"
                 : queue_job_state(record->queued) == JOB_FAILED ? "failed"
                                                                 : "succeeded");
    return NULL;
}

enum request_outcome requests_job_pause(struct request *request)
{
    struct job_record *record = find_live_job(request);

    if (!record) return REQUEST_FAILED;
    job_change_pause(request->farm, record, request->client->user);
    return commit_change(request, record);
}

enum request_outcome requests_job_resume(struct request *request)
{
    struct job_record *record = find_live_job(request);

    if (!record) return REQUEST_FAILED;
    request->code = MESSAGE_CODE_NOT_ALLOWED;
    if (!limits_check_disk(request->farm, record, &request->error)) return REQUEST_FAILED;
    job_change_resume(request->farm, record, request->client->user);
    return commit_change(request, record);
}

enum request_outcome requests_job_cancel(struct request *request)
{
    struct job_record *record = find_live_job(request);

    if (!record) return REQUEST_FAILED;
    if (!queue_has_frame_to_cancel(record->queued))
        return request_fail(request, MESSAGE_CODE_CONFLICT,
                            "job %lld succeeds in a moment: nothing is left to cancel, its last %lld frames are being "
                            "published",
                            (long long)record->id, (long long)record->queued->states.counts[FRAME_RUNNING]);
    job_change_cancel(request->farm, record, request->client->user);
    return commit_change(request, record);
}

enum request_outcome requests_job_priority(struct request *request)
{
    struct json_node node = json_node_child(&request->params, "priority");
    struct job_record *record = find_live_job(request);
    int64_t priority;

    if (!record) return REQUEST_FAILED;
    request->code = MESSAGE_CODE_PARAMS;
    if (!json_read_integer(&node, 0, JOB_PRIORITY_MAX, &priority, &request->error)) return REQUEST_FAILED;
    if (!request_may_have_priority(request, priority)) return REQUEST_FAILED;
    job_change_set_priority(request->farm, record, (int)priority, request->client->user);
    return commit_change(request, record);
}

// A job that is over does not protect its files: another job may write them.
static bool check_files_are_free(struct request *request, const struct job_record *record)
{
    struct job_files files = job_record_files(record);
    struct frame_set marks = {0};
    const struct job_record *other;
    const char *name;
    int32_t frame;

    if (queue_job_is_live(record->queued)) return true;
    files.marks = &marks;
    other = job_table_find_collision(&request->farm->jobs, &files, &frame);
    if (!other) other = job_table_find_ending(&request->farm->jobs, &files, &frame);
    name = other ? NULL : output_claims_find_collision(request->farm, &files, &frame);
    frame_set_finish(&marks);
    if (other)
        request_fail(request, MESSAGE_CODE_CONFLICT, "job %lld: job %lld (\"%s\") writes its frame %d too",
                     (long long)record->id, (long long)other->id, other->name, frame);
    else if (name)
        request_fail(request, MESSAGE_CODE_CONFLICT, "job %lld: a job just submitted (\"%s\") writes its frame %d too",
                     (long long)record->id, name, frame);
    return !other && !name;
}

static bool check_readable(struct request *request, const struct job_record *record)
{
    if (!record->is_unreadable) return true;
    request_fail(request, MESSAGE_CODE_CONFLICT, "job %lld: %s", (long long)record->id, record->reason);
    return false;
}

static bool check_stays(struct request *request, const struct job_record *record)
{
    if (!record->is_deleting) return true;
    request_fail(request, MESSAGE_CODE_CONFLICT, "job %lld is being deleted", (long long)record->id);
    return false;
}

enum request_outcome requests_job_delete(struct request *request)
{
    struct job_record *record = request_find_own_job(request);
    bool with_files = false;

    if (!record || !check_stays(request, record) || !request_read_flag(request, "files", &with_files))
        return REQUEST_FAILED;
    if (queue_job_is_live(record->queued) || record->is_retry_waiting)
        return request_fail(request, MESSAGE_CODE_CONFLICT, "job %lld is not over: cancel it first",
                            (long long)record->id);
    job_delete_start(request->farm, record,
                     &(struct job_delete_params){.with_files = with_files,
                                                 .user = request->client->user,
                                                 .answer = request_defer_answer(request, false)});
    return REQUEST_DEFERRED;
}

enum request_outcome requests_job_retry(struct request *request)
{
    const unsigned allowed = 1U << FRAME_FAILED | 1U << FRAME_CANCELED | 1U << FRAME_SUCCEEDED | 1U << FRAME_SKIPPED;
    const char *trouble = committer_trouble(request->farm->committer);
    struct job_record *record = request_find_own_job(request);
    const char *range;
    bool is_forced = false;
    unsigned states;

    if (!record || !check_stays(request, record) || !check_readable(request, record) ||
        !request_read_flag(request, "force", &is_forced) ||
        !request_read_set(request, "state", frame_state_names, 1U << FRAME_FAILED, &states))
        return REQUEST_FAILED;
    if (states & ~allowed)
        return request_fail(request, MESSAGE_CODE_PARAMS,
                            "params.state: expected failed, canceled, succeeded or skipped: queued and running frames "
                            "cannot be retried");
    if (trouble) return request_fail(request, MESSAGE_CODE_STORE, "%s", trouble);
    if (!check_files_are_free(request, record) || !request_read_range(request, &range)) return REQUEST_FAILED;
    job_retry_start(
        request->farm, record,
        &(struct job_retry_params){.states = states,
                                   .range = range,
                                   .is_forced = is_forced,
                                   .user = request->client->user,
                                   .by_admin = rights_is_admin(&request->farm->rights, &request->client->peer),
                                   .answer = request_defer_answer(request, true)});
    return REQUEST_DEFERRED;
}

enum request_outcome requests_job_submit(struct request *request)
{
    struct json_node document = json_node_child(&request->params, "document");
    bool paused = false;

    request->code = MESSAGE_CODE_PARAMS;
    if (!json_check_object(&document, &request->error) || !request_read_flag(request, "paused", &paused))
        return REQUEST_FAILED;
    return job_submit_start(request, &document, paused) ? REQUEST_DEFERRED : REQUEST_FAILED;
}
