// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/json/json_write.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/events.h"
#include "daemon/jobs/job_etas.h"
#include "daemon/jobs/job_view.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_reader.h"
#include "daemon/workers/worker_pool.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void write_job_counts(const struct farm *farm, struct json_writer *writer)
{
    int64_t counts[JOB_STATE_COUNT] = {0};

    for (size_t i = 0; i < farm->jobs.count; i++)
        counts[queue_job_state(farm->jobs.records[i]->queued)]++;
    json_write_begin_object(writer);
    for (int state = 0; state < JOB_STATE_COUNT; state++)
        json_write_integer_member(writer, job_state_name((enum job_state)state), counts[state]);
    json_write_end_object(writer);
}

static void write_frame_counts(const struct farm *farm, struct json_writer *writer)
{
    json_write_begin_object(writer);
    for (int state = 0; state < FRAME_STATE_COUNT; state++)
        json_write_integer_member(writer, frame_state_name((enum frame_state)state),
                                  queue_count(farm->queue, (enum frame_state)state));
    json_write_end_object(writer);
}

static void write_roots(struct json_writer *writer, const char *key, const struct path_list *roots)
{
    json_write_key(writer, key);
    json_write_begin_array(writer);
    for (size_t i = 0; i < roots->count; i++)
        json_write_string(writer, roots->paths[i]);
    json_write_end_array(writer);
}

static void write_store(const struct farm *farm, struct json_writer *writer)
{
    const struct committer *committer = farm->committer;
    const char *trouble = committer_trouble(committer);

    json_write_begin_object(writer);
    json_write_string_member(writer, "state", !trouble ? "ok" : committer_has_failed(committer) ? "failing" : "short");
    json_write_string_member(writer, "reason", trouble);
    json_write_integer_member(writer, "waiting", (int64_t)committer_waiting(committer));
    json_write_end_object(writer);
}

static void write_known_roots(struct json_writer *writer, const struct root_table *table)
{
    json_write_key(writer, "roots");
    json_write_begin_array(writer);
    for (size_t i = 0; i < table->count; i++) {
        const struct root *root = table->roots[i];

        if (!root->is_watched) continue;
        json_write_begin_object(writer);
        json_write_string_member(writer, "path", root->path);
        json_write_string_member(writer, "id", *root->id ? root->id : NULL);
        json_write_bool_member(writer, "is_there", root->is_there);
        json_write_string_member(writer, "reason", root->trouble);
        json_write_end_object(writer);
    }
    json_write_end_array(writer);
}

static void write_drain(const struct farm *farm, struct json_writer *writer)
{
    if (!farm->drain.user) {
        json_write_null(writer);
        return;
    }
    json_write_begin_object(writer);
    json_write_string_member(writer, "user", farm->drain.user);
    json_write_number_member(writer, "since", (double)farm->drain.since_ms / 1000);
    json_write_end_object(writer);
}

static void write_turns(const struct farm *farm, struct json_writer *writer)
{
    const struct turn_counts *turns = loop_turns_counts(farm->turns);

    json_write_begin_object(writer);
    json_write_number_member(writer, "longest_ms", (double)turns->longest_ns / 1e6);
    json_write_number_member(writer, "sum_s", (double)turns->sum_ns / 1e9);
    json_write_key(writer, "up_to_ms");
    json_write_begin_array(writer);
    for (int i = 0; i < TURN_CLASS_COUNT - 1; i++)
        json_write_integer(writer, turn_class_ms[i]);
    json_write_end_array(writer);
    json_write_key(writer, "counts");
    json_write_begin_array(writer);
    for (int i = 0; i < TURN_CLASS_COUNT; i++)
        json_write_integer(writer, (int64_t)turns->counts[i]);
    json_write_end_array(writer);
    json_write_end_object(writer);
}

static void write_nodes(const struct farm *farm, struct json_writer *writer)
{
    int up, waiting;

    worker_pool_count_nodes(farm->pool, &up, &waiting);
    json_write_begin_object(writer);
    json_write_integer_member(writer, "up", up);
    json_write_integer_member(writer, "waiting", waiting);
    json_write_end_object(writer);
}

enum request_outcome requests_daemon_status(struct request *request)
{
    const struct farm *farm = request->farm;
    struct json_writer *writer = request->result;

    json_write_begin_object(writer);
    json_write_string_member(writer, "version", MARCHD_VERSION);
    json_write_integer_member(writer, "pid", getpid());
    json_write_number_member(writer, "started", (double)farm->started_ms / 1000);
    json_write_string_member(writer, "output_root", farm->options->output_roots.paths[0]);
    write_roots(writer, "output_roots", &farm->options->output_roots);
    write_roots(writer, "input_roots", &farm->options->input_roots);
    write_known_roots(writer, &farm->roots);
    json_write_string_member(writer, "state_folder", farm->options->state_folder);
    json_write_key(writer, "store");
    write_store(farm, writer);
    json_write_key(writer, "jobs");
    write_job_counts(farm, writer);
    json_write_key(writer, "frames");
    write_frame_counts(farm, writer);
    json_write_integer_member(writer, "workers", worker_pool_slot_count(farm->pool));
    json_write_key(writer, "nodes");
    write_nodes(farm, writer);
    json_write_key(writer, "drain");
    write_drain(farm, writer);
    json_write_key(writer, "loop");
    write_turns(farm, writer);
    json_write_end_object(writer);
    return REQUEST_ANSWERED;
}

enum request_outcome requests_worker_list(struct request *request)
{
    const struct worker_pool *pool = request->farm->pool;
    struct json_writer *writer = request->result;

    json_write_begin_object(writer);
    json_write_key(writer, "workers");
    json_write_begin_array(writer);
    for (int i = 0; i < worker_pool_slot_count(pool); i++)
        worker_pool_write_slot(pool, i, writer);
    json_write_end_array(writer);
    json_write_end_object(writer);
    return REQUEST_ANSWERED;
}

enum request_outcome requests_events_subscribe(struct request *request)
{
    struct json_node id = json_node_child(&request->params, "id");
    struct job_record *record = NULL;
    bool wants_frames = true;

    if (!json_node_is_absent(&id) && !(record = request_find_job(request))) return REQUEST_FAILED;
    if (!request_read_flag(request, "frames", &wants_frames)) return REQUEST_FAILED;
    if (!events_subscribe(request->farm->events, request->client, record ? record->id : 0, wants_frames))
        return request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "events: a connection may subscribe 64 times");
    json_write_begin_object(request->result);
    json_write_end_object(request->result);
    return REQUEST_ANSWERED;
}

// A job that is deleted may be named: its subscription is still there.
enum request_outcome requests_events_unsubscribe(struct request *request)
{
    int64_t job;

    if (!request_read_count(request, "id", 1, INT64_C(1) << 53, 0, &job)) return REQUEST_FAILED;
    events_unsubscribe(request->farm->events, request->client, job);
    json_write_begin_object(request->result);
    json_write_end_object(request->result);
    return REQUEST_ANSWERED;
}

enum request_outcome requests_job_show(struct request *request)
{
    struct job_record *record = request_find_job(request);
    struct job_etas etas = {0};
    char *document = NULL;

    if (!record) return REQUEST_FAILED;
    request->code = MESSAGE_CODE_INTERNAL;
    // The document holds text of files that other users may not be allowed to read.
    if (!record->is_unreadable && request_may_change(request, record) &&
        !store_read_document(request->farm->reader, record->id, &document, &request->error))
        return REQUEST_FAILED;
    json_write_begin_object(request->result);
    job_view_write_members(request->farm, &etas, record, request->result);
    job_etas_finish(&etas);
    json_write_key(request->result, "document");
    if (document)
        json_write_raw(request->result, document, strlen(document));
    else
        json_write_null(request->result);
    json_write_end_object(request->result);
    free(document);
    return REQUEST_ANSWERED;
}
