// SPDX-License-Identifier: Apache-2.0
#include "worker/process/orders.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/frame_range.h"
#include "core/job/job_check.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "worker/answer/request.h"
#include "worker/answer/requests.h"
#include "worker/plan/draft.h"
#include "worker/process/plan_of.h"
#include "worker/process/report.h"
#include "worker/process/worker.h"

#include <limits.h>
#include <string.h>

static bool read_job_id(const struct json_node *params, int64_t *id, struct error *error)
{
    struct json_node node = json_node_child(params, "job");

    return json_read_integer(&node, 0, INT64_MAX, id, error);
}

static bool read_text(const struct json_node *params, const char *key, char **text, struct error *error)
{
    struct json_node node = json_node_child(params, key);
    const char *borrowed;

    if (!json_read_string(&node, &borrowed, error)) return false;
    *text = xstrdup(borrowed);
    return true;
}

// Chooses a draft's settings.
static bool settle(struct held_job *job, struct error *error)
{
    char reason[IMAGE_EXR_PLAN_SIZE];
    bool is_draft = job->job.quality.is_draft;

    if (!draft_settle(&job->job, reason, error)) return false;
    if (is_draft) job->draft = xstrdup(reason);
    return true;
}

static bool read_maybe_bool(const struct json_node *params, const char *key, bool *value, struct error *error)
{
    struct json_node node = json_node_child(params, key);

    return json_node_is_absent(&node) || json_read_bool(&node, value, error);
}

// Where the job's plans are from: members of the message that may be absent.
static bool read_plans(const struct json_node *params, struct held_job *job, struct error *error)
{
    struct json_node plan_of = json_node_child(params, "plan_of");

    return read_maybe_bool(params, "plans", &job->asks_plans, error) &&
           (json_node_is_absent(&plan_of) || read_text(params, "plan_of", &job->plan_of, error));
}

static bool read_maybe_text(const struct json_node *params, const char *key, char **text, struct error *error)
{
    struct json_node node = json_node_child(params, key);

    return json_node_is_absent(&node) || read_text(params, key, text, error);
}

// A document that cannot be read is a fault of the job, not a broken message: each of its frames then fails with it.
static bool take_job(struct worker *worker, const struct json_node *params, struct error *error)
{
    struct json_node document = json_node_child(params, "document");
    struct json_node root = json_node_root(document.value); // errors name positions as in the job file
    struct json_node epoch = json_node_child(params, "epoch");
    struct held_job *job = held_job_create();
    struct error reason = {0};

    if (!read_job_id(params, &job->id, error) || !json_read_integer(&epoch, 0, INT64_MAX, &job->epoch, error) ||
        !read_text(params, "root", &job->root, error) || !read_text(params, "owner", &job->owner, error) ||
        !read_maybe_text(params, "root_id", &job->root_id, error) ||
        !read_maybe_text(params, "farm_id", &job->farm_id, error) ||
        !read_maybe_text(params, "node", &job->node, error) ||
        !read_maybe_bool(params, "old_parts", &job->has_old_parts, error) || !read_plans(params, job, error) ||
        !read_maybe_text(params, "preview", &job->preview, error)) {
        held_job_destroy(job);
        return false;
    }
    if (!job_from_json(&job->job, &root, job->root, &reason) || !job_check_inputs(&job->job, &root, &reason) ||
        (job->plan_of && !plan_of_read(job, &root, &reason)) || !settle(job, &reason))
        job->fault = xstrdup(reason.message);
    pthread_mutex_lock(&worker->lock);
    assignment_add_job(&worker->assignment, job);
    pthread_mutex_unlock(&worker->lock);
    return true;
}

static bool take_plan(struct worker *worker, const struct json_node *params, struct error *error)
{
    struct held_job *job;
    bool ok = true;
    int64_t id;

    if (!read_job_id(params, &id, error)) return false;
    pthread_mutex_lock(&worker->lock);
    job = assignment_find_job(&worker->assignment, id);
    if (job && !job->fault) ok = plan_mail_take(&job->plans, params, &job->job, error);
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
    return ok;
}

static bool take_frame(struct worker *worker, int64_t job, const struct json_node *pair, struct error *error)
{
    struct json_node first = json_node_element(pair, 0), second = json_node_element(pair, 1);
    struct json_node forced = json_node_element(pair, 2);
    struct assignment_frame *added;
    int64_t frame, attempt;
    bool is_known = true, is_forced = false;

    if (!json_check_array(pair, 2, 3, error)) return false;
    if (!json_node_is_absent(&forced) && !json_read_bool(&forced, &is_forced, error)) return false;
    if (!json_read_integer(&first, 0, FRAME_NUMBER_LIMIT - 1, &frame, error)) return false;
    if (!json_read_integer(&second, 0, INT_MAX, &attempt, error)) return false;
    pthread_mutex_lock(&worker->lock);
    if (worker->is_exiting) {
        report_dropped(&worker->connection, &(struct assignment_dropped){job, (int32_t)frame, (int)attempt});
    } else {
        added = assignment_add_frame(&worker->assignment, job, (int32_t)frame, (int)attempt);
        is_known = added != NULL;
        if (added) added->is_forced = is_forced;
    }
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
    return is_known || json_fail(pair, error, "expected worker.job to tell of the job before");
}

static bool take_assignment(struct worker *worker, const struct json_node *params, struct error *error)
{
    struct json_node frames = json_node_child(params, "frames");
    struct json_node pair = {0};
    int64_t job;

    if (!read_job_id(params, &job, error) || !json_check_array(&frames, 0, FRAME_COUNT_LIMIT, error)) return false;
    while (json_node_next(&frames, &pair))
        if (!take_frame(worker, job, &pair, error)) return false;
    return true;
}

static bool take_drop(struct worker *worker, const struct json_node *params, struct error *error)
{
    struct assignment_dropped dropped;
    bool is_running = false;
    int64_t job;

    if (!read_job_id(params, &job, error)) return false;
    if (!read_maybe_bool(params, "running", &is_running, error)) return false;
    pthread_mutex_lock(&worker->lock);
    while (assignment_drop_waiting(&worker->assignment, job, &dropped))
        report_dropped(&worker->connection, &dropped);
    if (is_running) assignment_unwant_started(&worker->assignment, job);
    pthread_mutex_unlock(&worker->lock);
    return true;
}

static bool take_forget(struct worker *worker, const struct json_node *params, struct error *error)
{
    int64_t job;

    if (!read_job_id(params, &job, error)) return false;
    pthread_mutex_lock(&worker->lock);
    assignment_forget_job(&worker->assignment, job);
    pthread_mutex_unlock(&worker->lock);
    return true;
}

static bool take_exit(struct worker *worker, const struct json_node *params, struct error *error)
{
    worker_exit(worker, 0);
    return true;
}

static bool take_notification(struct worker *worker, const struct message *message, struct error *error)
{
    static const struct {
        const char *method;
        bool (*take)(struct worker *worker, const struct json_node *params, struct error *error);
    } orders[] = {
        {"worker.job", take_job},   {"worker.assign", take_assignment}, {"worker.drop", take_drop},
        {"worker.plan", take_plan}, {"worker.forget", take_forget},     {"worker.exit", take_exit},
    };

    for (size_t i = 0; i < sizeof orders / sizeof orders[0]; i++) {
        if (strcmp(message->method, orders[i].method) != 0) continue;
        if (orders[i].take(worker, &message->body, error)) return true;
        error_prefix(error, "%s", message->method);
        return false;
    }
    error_set(error, "%s: no such order", message->method);
    return false;
}

static void refuse_request(struct worker *worker, const char *id, enum message_code code, const char *text)
{
    struct json_writer writer = {0};

    message_write_error(&writer, id, code, text);
    connection_send(&worker->connection, &writer);
    json_writer_finish(&writer);
}

// Takes the message over.
static void take_request(struct worker *worker, struct message *message)
{
    struct request **link = &worker->requests;
    struct request *request;

    if (!requests_is_known(message->method)) {
        refuse_request(worker, message->id, MESSAGE_CODE_NO_METHOD, "no such method");
        message_finish(message);
        return;
    }
    request = request_create(message);
    pthread_mutex_lock(&worker->lock);
    while (*link)
        link = &(*link)->next;
    *link = request;
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
}

bool orders_take_line(struct worker *worker, const char *line, size_t length, struct error *error)
{
    enum message_code code;
    struct message message;
    bool ok = false;

    if (!message_decode(&message, line, length, &code, error)) return false;
    switch (message.kind) {
    case MESSAGE_REQUEST:
        take_request(worker, &message);
        return true;
    case MESSAGE_NOTIFICATION:
        ok = take_notification(worker, &message, error);
        break;
    default:
        error_set(error, "expected an order, got an answer to no question");
    }
    message_finish(&message);
    return ok;
}
