// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/loop/work_desk.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_reader.h"

#include <stdlib.h>
#include <string.h>

// Plans are read from the store off the loop. Of each those parts are told that say what is rendered, and why.
struct plans_task {
    struct work_piece piece;
    const struct farm *farm;   // borrowed; outlives us
    struct answer *answer;     // owned
    struct job_record *record; // held
    const char *state_folder;  // borrowed; outlives us
    int limit;
    struct json_writer value;
    bool ok;
    struct error error;
};

static void on_flushed(void *user, bool ok, const struct error *error);
static void on_plans_run(struct work_piece *piece);
static void on_plans_done(struct work_piece *piece, bool was_run);

enum request_outcome requests_job_plans(struct request *request)
{
    struct job_record *record = request_find_job(request);
    struct plans_task *task;
    int64_t limit;

    if (!record || !request_read_count(request, "limit", 1, PLANS_LIMIT, PLANS_DEFAULT, &limit)) return REQUEST_FAILED;
    task = xcalloc(1, sizeof *task);
    task->farm = request->farm;
    task->record = record;
    job_record_hold(record);
    task->state_folder = request->farm->options->state_folder;
    task->limit = (int)limit;
    task->answer = request_defer_answer(request, true);
    task->piece = (struct work_piece){.run = on_plans_run, .done = on_plans_done, .uid = request->client->peer.uid};
    committer_flush(request->farm->committer, on_flushed, task);
    return REQUEST_DEFERRED;
}

static void on_flushed(void *user, bool ok, const struct error *error)
{
    struct plans_task *task = user;

    work_desk_put(task->farm->work, &task->piece);
}

// `absent` NULL: a part that is absent is not written.
static void write_part(struct json_writer *writer, const struct json_node *plan, const char *key, const char *absent)
{
    struct json_node part = json_node_child(plan, key);
    char *text;

    if (json_node_is_absent(&part) && !absent) return;
    text = json_node_is_absent(&part) ? xstrdup(absent) : json_node_format(&part);
    json_write_key(writer, key);
    json_write_raw(writer, text, strlen(text));
    free(text);
}

static bool on_plan(void *user, int64_t number, const char *text, struct error *error)
{
    struct plans_task *task = user;
    struct cJSON *root = NULL;
    struct json_node plan;

    if (!json_parse(&root, text, strlen(text), error)) return false;
    plan = json_node_root(root);
    json_write_begin_object(&task->value);
    json_write_integer_member(&task->value, "number", number);
    write_part(&task->value, &plan, "quality", "{}");
    write_part(&task->value, &plan, "why", "\"\"");
    write_part(&task->value, &plan, "scouts", "[]");
    write_part(&task->value, &plan, "beyond", NULL);
    json_write_end_object(&task->value);
    json_delete(root);
    return true;
}

static void on_plans_run(struct work_piece *piece)
{
    struct plans_task *task = (struct plans_task *)piece;
    struct store_reader *reader = store_reader_open(task->state_folder, &task->error);

    if (!reader) return;
    json_write_begin_object(&task->value);
    json_write_key(&task->value, "plans");
    json_write_begin_array(&task->value);
    task->ok = store_read_plans(reader, task->record->owner_uid, task->record->facts.hash, task->limit, on_plan, task,
                                &task->error);
    json_write_end_array(&task->value);
    json_write_end_object(&task->value);
    store_reader_close(reader);
}

static void on_plans_done(struct work_piece *piece, bool was_run)
{
    struct plans_task *task = (struct plans_task *)piece;

    if (!was_run) error_set(&task->error, "the daemon stops: ask the next one");
    if (task->ok)
        answer_send_result(task->answer, &task->value);
    else
        answer_send_error(task->answer, MESSAGE_CODE_INTERNAL, task->error.message);
    job_record_release(task->record);
    json_writer_finish(&task->value);
    free(task);
}
