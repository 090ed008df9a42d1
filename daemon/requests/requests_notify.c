// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/notices.h"
#include "daemon/loop/work_desk.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_reader.h"

#include <stdlib.h>
#include <string.h>

enum { NOTICES_DEFAULT = 100, NOTICES_LIMIT = 1000, ERROR_LIMIT = 200 };
static const int64_t NOTICE_ID_MAX = (INT64_C(1) << 53) - 1; // of JSON
static const size_t ANSWER_SIZE = 1 << 20;                   // bytes from which an answer has no more notices

struct pending_task {
    struct work_piece piece;
    struct answer *answer;    // owned
    const char *state_folder; // borrowed; outlives us
    int64_t after;
    int limit;
    int64_t dropped;
    struct json_writer value;
    bool ok;
    struct error error;
};

static void on_pending_run(struct work_piece *piece);
static void on_pending_done(struct work_piece *piece, bool was_run);
static void on_done_committed(void *user, bool ok, const struct error *error);

static bool read_integer(struct request *request, const char *key, int64_t max, int64_t *integer)
{
    struct json_node node = json_node_child(&request->params, key);

    request->code = MESSAGE_CODE_PARAMS;
    return json_node_is_absent(&node) || json_read_integer(&node, 0, max, integer, &request->error);
}

static bool read_targets(struct request *request, struct notice_targets *targets)
{
    struct json_node node = json_node_child(&request->params, "targets"), child = {0};
    const char *name;

    if (!request_read_flag(request, "webhooks", &targets->has_webhooks)) return false;
    if (json_node_is_absent(&node)) return true;
    targets->is_known = true;
    if (!json_check_array(&node, 0, NOTICE_TARGETS_LIMIT, &request->error)) return false;
    while (json_node_next(&node, &child)) {
        if (!json_read_string(&child, &name, &request->error)) return false;
        if (!job_notify_is_name(name)) return json_fail_expected(&child, &request->error, "a target's name");
        notice_targets_add(targets, name);
    }
    return true;
}

// Whom jobs may name from now on, if the client says so.
static bool take_targets(struct request *request)
{
    struct notice_targets targets = {0};

    if (!read_targets(request, &targets)) {
        notice_targets_finish(&targets);
        return false;
    }
    if (!targets.is_known) return true;
    notice_targets_finish(&request->farm->targets);
    request->farm->targets = targets;
    return true;
}

static void begin_answer(struct json_writer *value)
{
    json_write_begin_object(value);
    json_write_key(value, "notices");
    json_write_begin_array(value);
}

static void end_answer(struct json_writer *value, int64_t dropped)
{
    json_write_end_array(value);
    json_write_integer_member(value, "dropped", dropped);
    json_write_end_object(value);
}

enum request_outcome requests_notify_pending(struct request *request)
{
    struct farm *farm = request->farm;
    int64_t after = 0, limit = NOTICES_DEFAULT;
    struct pending_task *task;

    if (!read_integer(request, "after", NOTICE_ID_MAX, &after) ||
        !read_integer(request, "limit", NOTICES_LIMIT, &limit) || !take_targets(request))
        return REQUEST_FAILED;
    if (farm->notices.count == 0) {
        begin_answer(request->result);
        end_answer(request->result, farm->notices.dropped);
        return REQUEST_ANSWERED;
    }
    task = xcalloc(1, sizeof *task);
    *task = (struct pending_task){
        .piece = {.run = on_pending_run, .done = on_pending_done, .uid = request->client->peer.uid},
        .answer = request_defer_answer(request, true),
        .state_folder = farm->options->state_folder,
        .after = after,
        .limit = (int)limit,
        .dropped = farm->notices.dropped};
    work_desk_put(farm->work, &task->piece);
    return REQUEST_DEFERRED;
}

static bool on_notice(void *user, const struct store_notice *notice, struct error *error)
{
    struct json_writer *writer = user;

    (void)error;
    if (writer->length > ANSWER_SIZE) return true;
    json_write_begin_object(writer);
    json_write_integer_member(writer, "id", notice->id);
    json_write_integer_member(writer, "job", notice->job);
    json_write_integer_member(writer, "owner_uid", notice->owner_uid);
    json_write_number_member(writer, "made", (double)notice->made_ms / 1000);
    json_write_string_member(writer, "event", notice->event);
    json_write_string_member(writer, "to", notice->is_webhook ? NULL : notice->target);
    json_write_string_member(writer, "webhook", notice->is_webhook ? notice->target : NULL);
    json_write_string_member(writer, "body", notice->body);
    json_write_end_object(writer);
    return true;
}

static void on_pending_run(struct work_piece *piece)
{
    struct pending_task *task = (struct pending_task *)piece;
    struct store_reader *reader = store_reader_open(task->state_folder, &task->error);

    if (!reader) return;
    begin_answer(&task->value);
    task->ok = store_read_notices(reader, task->after, task->limit, on_notice, &task->value, &task->error);
    end_answer(&task->value, task->dropped);
    store_reader_close(reader);
}

static void on_pending_done(struct work_piece *piece, bool was_run)
{
    struct pending_task *task = (struct pending_task *)piece;

    if (!was_run) error_set(&task->error, "the daemon stops: ask the next one");
    if (task->ok)
        answer_send_result(task->answer, &task->value);
    else
        answer_send_error(task->answer, MESSAGE_CODE_INTERNAL, task->error.message);
    json_writer_finish(&task->value);
    free(task);
}

// The log says what became of a notice that could not be delivered.
static bool log_failure(struct request *request, int64_t id)
{
    struct json_node node = json_node_child(&request->params, "error");
    const char *text;
    char *copy;

    if (json_node_is_absent(&node)) return true;
    if (!json_read_string(&node, &text, &request->error)) return false;
    copy = xstrndup(text, ERROR_LIMIT);
    log_disarm(copy);
    log_warn("notice %lld is given up: %s", (long long)id, copy);
    free(copy);
    return true;
}

enum request_outcome requests_notify_done(struct request *request)
{
    struct json_node node = json_node_child(&request->params, "id");
    struct store_op op;
    int64_t id;

    request->code = MESSAGE_CODE_PARAMS;
    if (!json_read_integer(&node, 1, NOTICE_ID_MAX, &id, &request->error) || !log_failure(request, id))
        return REQUEST_FAILED;
    op = notices_drop(request->farm, id);
    committer_put(request->farm->committer, COMMIT_REPORTED, &op, 1, on_done_committed,
                  request_defer_answer(request, false));
    return REQUEST_DEFERRED;
}

static void on_done_committed(void *user, bool ok, const struct error *error)
{
    struct json_writer value = {0};

    if (!ok) {
        answer_send_error(user, MESSAGE_CODE_STORE, error->message);
        return;
    }
    json_write_begin_object(&value);
    json_write_end_object(&value);
    answer_send_result(user, &value);
    json_writer_finish(&value);
}
