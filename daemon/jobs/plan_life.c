// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/plan_life.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/job.h"
#include "core/job/job_check.h"
#include "core/job/job_json.h"
#include "core/job/plan_json.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "daemon/farm/farm.h"
#include "daemon/loop/memory_return.h"
#include "daemon/loop/work_desk.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_reader.h"
#include "daemon/workers/worker_pool.h"

#include <stdlib.h>
#include <string.h>

// A question, the first plan of a segment, and the next after a miss.
enum { MESSAGES_OF_AN_ATTEMPT = 3 };

// A plan that is checked in a thread, for the job's document may be long, then committed.
struct plan_commit {
    struct work_piece piece;
    struct job_record *record; // held while it is checked
    char *made;                // owned; what the worker sent, as the message that errors name places of
    int64_t missed;            // the number of the plan that it replaces; 0: none
    bool ok;
    struct error error;
    struct farm *farm; // borrowed
    struct plan_key key;
    struct plan_asker maker;
    int64_t number;
    char *text;      // owned
    bool is_errand;  // others may wait for it
    bool is_replace; // it replaces a plan that workers have
};

static void on_check_run(struct work_piece *piece);
static void on_check_done(struct work_piece *piece, bool was_run);
static void on_committed(void *user, bool ok, const struct error *error);

static struct plan_key find_key(const struct job_record *record, const char *segment)
{
    struct plan_key key = {.owner_uid = record->owner_uid};

    memcpy(key.scene, record->facts.hash, sizeof key.scene);
    memccpy(key.segment, segment, 0, sizeof key.segment - 1);
    return key;
}

static struct plan_asker find_asker(const struct queue_ticket *ticket)
{
    return (struct plan_asker){ticket->job, ticket->frame, ticket->attempt};
}

static void begin_answer(struct json_writer *writer, const char *segment, int64_t job, const char *word)
{
    message_begin_notification(writer, "worker.plan");
    json_write_begin_object(writer);
    json_write_integer_member(writer, "job", job);
    json_write_string_member(writer, "key", segment);
    json_write_string_member(writer, "say", word);
}

static void write_plan(struct json_writer *writer, int64_t number, const char *text)
{
    json_write_integer_member(writer, "number", number);
    json_write_key(writer, "plan");
    json_write_raw(writer, text, strlen(text));
}

// Ends the answer and sends it, unless the attempt is over.
static void send_answer(struct farm *farm, struct json_writer *writer, const struct plan_asker *asker)
{
    struct worker_process *worker = worker_pool_find_holder(farm->pool, asker->job, asker->frame, asker->attempt);

    json_write_integer_member(writer, "frame", asker->frame);
    json_write_integer_member(writer, "attempt", asker->attempt);
    json_write_end_object(writer);
    message_end(writer);
    if (worker) worker_process_send(worker, writer);
    json_writer_finish(writer);
}

static void send_word(struct farm *farm, const struct plan_key *key, const struct plan_asker *asker, const char *word)
{
    struct json_writer writer = {0};

    begin_answer(&writer, key->segment, asker->job, word);
    send_answer(farm, &writer, asker);
}

static void send_plan(struct farm *farm, const struct plan_key *key, const struct plan_asker *asker, int64_t number,
                      const char *text)
{
    struct json_writer writer = {0};

    begin_answer(&writer, key->segment, asker->job, "plan");
    write_plan(&writer, number, text);
    send_answer(farm, &writer, asker);
}

static void refuse(struct farm *farm, const struct plan_key *key, const struct plan_asker *asker, const char *why)
{
    struct json_writer writer = {0};

    begin_answer(&writer, key->segment, asker->job, "refuse");
    json_write_string_member(&writer, "error", why);
    send_answer(farm, &writer, asker);
}

// All workers of the job use the new plan from their next frame on.
static void tell_workers(const struct plan_commit *commit)
{
    struct json_writer writer = {0};

    begin_answer(&writer, commit->key.segment, commit->maker.job, "plan");
    write_plan(&writer, commit->number, commit->text);
    json_write_end_object(&writer);
    message_end(&writer);
    worker_pool_tell(commit->farm->pool, commit->maker.job, &writer);
    json_writer_finish(&writer);
}

static void tell_to_make(struct farm *farm, const struct plan_key *key, const struct plan_asker *asker)
{
    const struct worker_process *worker = worker_pool_find_holder(farm->pool, asker->job, asker->frame, asker->attempt);

    log_debug("job %lld frame %d: worker %d makes the plan", (long long)asker->job, (int)asker->frame,
              worker ? worker->id : 0);
    send_word(farm, key, asker, "make");
}

static void note_ask(struct farm *farm, const struct plan_key *key, const struct plan_asker *asker)
{
    struct error error = {0};
    int64_t number = 0;
    char *text = NULL;

    if (plan_desk_is_busy(&farm->desk, key)) {
        (void)plan_desk_ask(&farm->desk, key, asker);
        send_word(farm, key, asker, "wait");
    } else if (!store_read_plan(farm->reader, key, &number, &text, &error)) {
        refuse(farm, key, asker, error.message);
    } else if (number > 0) {
        send_plan(farm, key, asker, number, text);
    } else {
        (void)plan_desk_ask(&farm->desk, key, asker);
        tell_to_make(farm, key, asker);
    }
    free(text);
}

// Checks the plan as if the job stated its quality. `*text` is owned by the caller: the plan as JSON, and nothing else.
static bool check_quality(const struct json_node *document, const char *root, const struct json_node *object,
                          char **text, struct error *error)
{
    struct json_writer writer = {0};
    struct job job = {0}, planned;
    struct plan_json plan;
    bool ok = false;

    if (!job_from_json(&job, document, root, error) || !plan_from_json(&plan, object, &job, error)) goto out;
    planned = job;
    planned.quality = plan.quality;
    if (!job_check(&planned, document, error)) goto out;
    plan_to_json(&writer, &plan, &job);
    *text = xstrndup(writer.text, writer.length);
    ok = true;
out:
    json_writer_finish(&writer);
    job_finish(&job);
    return ok;
}

static void on_check_run(struct work_piece *piece)
{
    struct plan_commit *commit = (struct plan_commit *)piece;
    struct store_reader *reader = store_reader_open(commit->farm->options->state_folder, &commit->error);
    struct cJSON *tree = NULL, *plan = NULL;
    char *document = NULL;

    commit->ok = reader && store_read_document(reader, commit->record->id, &document, &commit->error) &&
                 json_parse(&tree, document, strlen(document), &commit->error) &&
                 json_parse(&plan, commit->made, strlen(commit->made), &commit->error);
    if (commit->ok) {
        struct json_node root = json_node_root(tree), message = json_node_root(plan),
                         params = json_node_child(&message, "params"), object = json_node_child(&params, "plan");

        commit->ok = check_quality(&root, commit->record->root, &object, &commit->text, &commit->error);
    }
    json_delete(plan);
    json_delete(tree);
    memory_return_trim(document ? strlen(document) * MEMORY_RETURN_PARSED : 0);
    free(document);
    store_reader_close(reader);
}

static void drop(struct plan_commit *commit)
{
    free(commit->made);
    free(commit->text);
    free(commit);
}

static void on_committed(void *user, bool ok, const struct error *error)
{
    struct plan_commit *commit = user;
    struct farm *farm = commit->farm;

    (void)ok; // it is tried until it is on disk
    (void)error;
    if (commit->is_errand) {
        size_t count;
        struct plan_asker *askers = plan_desk_close(&farm->desk, &commit->key, &count);

        for (size_t i = 0; i < count; i++)
            send_plan(farm, &commit->key, &askers[i], commit->number, commit->text);
        free(askers);
    } else {
        send_plan(farm, &commit->key, &commit->maker, commit->number, commit->text);
    }
    if (commit->is_replace) tell_workers(commit);
    drop(commit);
}

static void put_plan(struct farm *farm, struct plan_commit *commit)
{
    struct store_op op = {.kind = STORE_ADD_PLAN};

    commit->number = farm->next_plan_number++;
    op.plan = (struct store_plan){.number = commit->number, .key = commit->key, .text = xstrdup(commit->text)};
    committer_put(farm->committer, COMMIT_CERTAIN, &op, 1, on_committed, commit);
}

// A worker may send the plan that it was told to make, and one in place of a plan that the store has.
static bool may_make(const struct farm *farm, const struct plan_commit *made, int64_t missed)
{
    int64_t newest = 0;
    char *text = NULL;

    if (plan_desk_is_maker(&farm->desk, &made->key, &made->maker)) return true;
    if (missed > 0 && !store_read_plan(farm->reader, &made->key, &newest, &text, NULL)) newest = 0;
    free(text);
    return missed > 0 && missed <= newest;
}

static void refuse_made(struct plan_commit *commit)
{
    struct log_subject subject = job_record_subject(commit->record);

    subject.frame = commit->maker.frame;
    error_prefix(&commit->error, "a plan is refused");
    log_about(LOG_WARN, &subject, "job %lld frame %d: %s", (long long)commit->maker.job, (int)commit->maker.frame,
              commit->error.message);
    refuse(commit->farm, &commit->key, &commit->maker, commit->error.message);
}

static void begin_commit(struct plan_commit *commit)
{
    struct farm *farm = commit->farm;
    struct log_subject subject = job_record_subject(commit->record);

    subject.frame = commit->maker.frame;
    commit->is_errand = plan_desk_begin_commit(&farm->desk, &commit->key, &commit->maker);
    log_about(LOG_INFO, &subject, "job %lld frame %d: plan %lld is made%s", (long long)commit->maker.job,
              (int)commit->maker.frame, (long long)farm->next_plan_number, commit->is_replace ? ", after a miss" : "");
    put_plan(farm, commit);
}

// The attempt may be over, and the job deleted.
static void on_check_done(struct work_piece *piece, bool was_run)
{
    struct plan_commit *commit = (struct plan_commit *)piece;
    struct job_record *record = commit->record;
    bool may_commit = was_run && !record->is_removed && may_make(commit->farm, commit, commit->missed);

    if (may_commit && !commit->ok) refuse_made(commit);
    if (may_commit && commit->ok)
        begin_commit(commit);
    else
        drop(commit);
    job_record_release(record);
}

static void note_made(struct farm *farm, const struct worker_report *report, const struct plan_key *key,
                      struct job_record *record, const struct plan_asker *maker)
{
    struct plan_commit *commit = xmalloc(sizeof *commit);
    char *made;

    *commit = (struct plan_commit){.piece = {.run = on_check_run,
                                             .done = on_check_done,
                                             .uid = record->owner_uid,
                                             .goes_on = true}, // a worker waits for it
                                   .farm = farm,
                                   .record = record,
                                   .key = *key,
                                   .maker = *maker,
                                   .missed = report->missed,
                                   .is_replace = report->missed > 0};
    if (!may_make(farm, commit, report->missed)) {
        refuse(farm, key, maker, "plan: expected one that the worker was told to make, or one after a miss");
        drop(commit);
        return;
    }
    made = json_node_format(&report->plan);
    commit->made = xasprintf("{\"params\":{\"plan\":%s}}", made);
    free(made);
    job_record_hold(record);
    work_desk_put(farm->work, &commit->piece);
}

void plan_life_note_report(struct farm *farm, const struct worker_report *report, struct job_record *record,
                           struct in_flight_frame *frame)
{
    struct plan_key key = find_key(record, report->key);
    struct plan_asker asker = find_asker(&frame->ticket);

    if (++frame->plan_messages > MESSAGES_OF_AN_ATTEMPT)
        refuse(farm, &key, &asker, "plan: expected fewer questions of one attempt");
    else if (report->kind == WORKER_REPORT_PLAN_MADE)
        note_made(farm, report, &key, record, &asker);
    else
        note_ask(farm, &key, &asker);
}

void plan_life_leave(struct farm *farm, const struct queue_ticket *ticket)
{
    struct plan_asker asker = find_asker(ticket), next;
    struct plan_key key;

    while (plan_desk_leave(&farm->desk, &asker, &key, &next))
        tell_to_make(farm, &key, &next);
}
