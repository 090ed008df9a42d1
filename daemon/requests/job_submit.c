// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/job_submit.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/base/path_list.h"
#include "core/job/frame_set.h"
#include "core/job/input_roots.h"
#include "core/job/job.h"
#include "core/job/output_root.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/limits.h"
#include "daemon/farm/pool_access.h"
#include "daemon/farm/shares.h"
#include "daemon/jobs/after_desk.h"
#include "daemon/jobs/job_life.h"
#include "daemon/jobs/root_desks.h"
#include "daemon/jobs/root_life.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/output/output_claims.h"
#include "daemon/output/output_older.h"
#include "daemon/requests/job_document.h"
#include "daemon/requests/request.h"
#include "daemon/requests/submit_checks.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/workers/worker_pool.h"

#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// A job between the check of its document and its commit.
struct job_submit {
    struct farm *farm;     // borrowed; outlives us
    struct answer *answer; // owned
    struct work_piece piece;
    struct store_job row;      // owned, until it moves into the commit
    struct frame_range frames; // owned
    struct root *output_root;  // borrowed from the farm
    struct output_path path;   // owned
    struct job_paths paths;    // owned; the files that it reads
    struct job_inputs inputs;  // owned; the same, below their roots
    char *code, *pool;         // owned; as in struct job_record
    struct job_notes notes;    // owned, until the record has them
    struct job_notify notify;  // likewise
    struct job_after after;    // likewise
    struct job_facts facts;
    struct frame_order order;
    struct quota_user *user;    // borrowed; the owner
    struct quota_amounts share; // its share of what the owner has, until the record has one
    int failure;                // enum message_code of `error`; 0: none
    struct error error;
    struct output_claim claim; // of its files
    struct frame_set marks;    // owned; of their frames
    struct output_older older; // owned; pictures of an older version of the job, if it asks before it replaces any
    struct loop_task task;
    struct job_submit *next; // on the farm's list of waiting submissions
};

static void on_document_read(struct job_document *reading, bool was_read);
static void on_folder_run(struct work_piece *piece);
static void on_folder_done(struct work_piece *piece, bool was_run);
static bool on_step(struct loop_task *task);
static void on_committed(void *user, bool ok, const struct error *error);

static void submit_destroy(struct job_submit *submit)
{
    struct store_op op = {.kind = STORE_ADD_JOB, .job = submit->row};

    quota_set(submit->user, &submit->share, (struct quota_amounts){0});
    store_op_finish(&op);
    frame_range_finish(&submit->frames);
    frame_set_finish(&submit->marks);
    output_path_finish(&submit->path);
    job_paths_finish(&submit->paths);
    job_inputs_finish(&submit->inputs);
    job_notes_finish(&submit->notes);
    job_notify_finish(&submit->notify);
    job_after_finish(&submit->after);
    free(submit->code);
    free(submit->pool);
    output_older_finish(&submit->older);
    free(submit);
}

static void refuse(struct job_submit *submit, enum message_code code, const char *text)
{
    output_claims_remove(submit->farm, &submit->claim);
    answer_send_error(submit->answer, code, text);
    submit_destroy(submit);
}

static bool fail_collision(struct request *request, const struct output_path *path, int32_t frame, int64_t id,
                           const char *name)
{
    char file[OUTPUT_NAME_SIZE];

    output_path_format_name(path, frame, file);
    if (id)
        request_fail(request, MESSAGE_CODE_CONFLICT, "output.path: job %lld (\"%s\") writes %s too", (long long)id,
                     name, file);
    else
        request_fail(request, MESSAGE_CODE_CONFLICT, "output.path: a job just submitted (\"%s\") writes %s too", name,
                     file);
    return false;
}

// Published files belong to the owner of their job: only the owner and administrators may replace them.
static bool check_owners(struct request *request, const struct job_files *files)
{
    const struct rights_peer *peer = &request->client->peer;
    const struct job_record *record;
    char file[OUTPUT_NAME_SIZE];
    int32_t frame;

    if (rights_is_admin(&request->farm->rights, peer)) return true;
    record = job_table_find_owned_files(&request->farm->jobs, files, peer->uid, &frame);
    if (!record) return true;
    output_path_format_name(files->path, frame, file);
    request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "output.path: %s belongs to job %lld of %s", file,
                 (long long)record->id, record->owner);
    return false;
}

static bool compare_files(struct request *request, const struct job_files *compared)
{
    const struct farm *farm = request->farm;
    const struct job_files files = *compared;
    const struct job_record *record;
    const char *name;
    int32_t frame;

    record = output_claims_find_removal(farm, &files);
    if (record) {
        request_fail(request, MESSAGE_CODE_CONFLICT,
                     "output.path: files of job %lld are being removed from this folder: try again",
                     (long long)record->id);
        return false;
    }
    record = job_table_find_collision(&farm->jobs, &files, &frame);
    if (record) return fail_collision(request, files.path, frame, record->id, record->name);
    name = output_claims_find_collision(farm, &files, &frame);
    if (name) return fail_collision(request, files.path, frame, 0, name);
    return check_owners(request, &files);
}

static bool check_collisions(struct request *request, const struct job *job, const char *root)
{
    struct frame_set marks = {0};
    const struct job_files files = {root, &job->output.path, &job->frames, &marks};
    bool ok = compare_files(request, &files);

    frame_set_finish(&marks);
    return ok;
}

// The root that the output goes below: the first, or the one that holds an absolute path. NULL, with the failure
// filled.
static const char *choose_root(struct request *request, const struct json_node *document)
{
    const struct path_list *roots = &request->farm->options->output_roots;
    struct json_node output = json_node_child(document, "output"), path = json_node_child(&output, "path");
    const char *text, *root;
    char list[512];

    // A value that is no path is reported when the document is read.
    if (!json_read_string(&path, &text, NULL) || *text != '/') return roots->paths[0];
    root = path_list_find_root(roots, text);
    if (root) return root;
    path_list_format(roots, list, sizeof list);
    request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "output.path: expected a path below %s, got \"%.200s\"", list,
                 text);
    return NULL;
}

static struct quota_amounts job_amounts(const struct job *job)
{
    int64_t frames = frame_range_count(&job->frames);

    return (struct quota_amounts){.jobs = 1, .frames = frames, .pixels = frames * job->width_px * job->height_px};
}

// The job has workers, and stays within the limits. Jobs that are being submitted count as well.
static bool check_limits(struct request *request, const struct job *job)
{
    struct farm *farm = request->farm;
    const struct rights_peer *peer = &request->client->peer;
    struct quota_user *user = limits_find_user(farm, peer, request->client->user);
    struct quota_user asking = *user;
    const struct quota_amounts amounts = job_amounts(job);

    // A token may give less than its user has: that holds for what is asked with it alone.
    asking.is_unlimited = rights_is_admin(&farm->rights, peer);
    pool_access_note_user(farm, &asking, peer);
    user->pools = peer->is_ordinary ? user->pools | asking.pools : asking.pools;
    request->code = MESSAGE_CODE_NOT_ALLOWED;
    if (!pool_access_check(farm, &asking, job->pool, &request->error)) {
        error_prefix(&request->error, "pool");
        return false;
    }
    return limits_check_submit(farm, &asking, &amounts, &request->error);
}

// Moves the parts that it needs out of the reading.
static struct job_submit *create_submit(const struct request *request, struct job_document *reading)
{
    struct job *job = &reading->job;
    struct job_submit *submit = xcalloc(1, sizeof *submit);

    submit->farm = request->farm;
    submit->answer = reading->answer;
    submit->row = (struct store_job){.document = reading->document,
                                     .name = xstrdup(job->name),
                                     .owner = xstrdup(request->client->user),
                                     .owner_uid = request->client->peer.uid,
                                     .priority = job->priority,
                                     .submitted_ms = farm_clock_ms(),
                                     .is_paused = reading->is_paused,
                                     .root = xstrdup(reading->root)};
    submit->paths = reading->paths;
    reading->answer = NULL;
    reading->document = NULL;
    reading->paths = (struct job_paths){0};
    submit->facts = job_facts_of(job);
    submit->order = job->order;
    submit->user = quota_find_user(&request->farm->quota, submit->row.owner_uid, submit->row.owner);
    quota_set(submit->user, &submit->share, job_amounts(job));
    submit->code = scene_find_code(&job->scene) ? xstrdup(scene_find_code(&job->scene)) : NULL;
    submit->pool = job->pool;
    job->pool = NULL;
    submit->frames = job->frames;
    submit->path = job->output.path;
    submit->notes = job->notes;
    job->notes = (struct job_notes){0};
    submit->notify = job->notify;
    job->notify = (struct job_notify){0};
    submit->after = job_after_take(&job->after);
    submit->row.waits = submit->after.count > 0;
    job->frames = (struct frame_range){0};
    job->output.path = (struct output_path){0};
    return submit;
}

// A root that was never there has no marker to open folders by.
static struct root *find_root(struct request *request, const char *path)
{
    struct root *root = root_table_find(&request->farm->roots, path);

    if (root && root->is_there) return root;
    request_fail(request, MESSAGE_CODE_CONFLICT, "output.path: %s",
                 root && root->trouble ? root->trouble : "its output root is not known yet: try again");
    return NULL;
}

static bool find_inputs(struct request *request, const struct job_paths *paths, struct job_inputs *inputs)
{
    request->code = MESSAGE_CODE_NOT_ALLOWED;
    return input_roots_find(inputs, paths, &request->farm->options->input_roots, &request->error);
}

// Waits for canceled jobs whose last frames are still with workers, and will soon leave these files alone.
static void begin(struct job_submit *submit)
{
    struct farm *farm = submit->farm;
    int32_t frame;

    if (job_table_find_ending(&farm->jobs, &submit->claim.files, &frame)) {
        submit->next = farm->waiting_submits;
        farm->waiting_submits = submit;
    } else {
        root_desks_put(farm->root_desks, submit->output_root, &submit->piece);
    }
}

void job_submit_go_on(struct farm *farm)
{
    struct job_submit *waiting = farm->waiting_submits;

    farm->waiting_submits = NULL;
    while (waiting) {
        struct job_submit *submit = waiting;

        waiting = submit->next;
        begin(submit);
    }
}

bool job_submit_start(struct request *request, const struct json_node *document, bool paused)
{
    const char *root = choose_root(request, document);

    if (!root || !submit_checks_peer(request)) return false;
    job_document_read(request, root, paused, on_document_read);
    return true;
}

// The job is one that the client may submit now: its files are checked in a thread, and are its own until then.
static bool begin_submit(struct request *request, struct job_document *reading)
{
    const struct job *job = &reading->job;
    struct job_inputs inputs = {0};
    struct root *output_root = find_root(request, reading->root);
    struct job_submit *submit;

    if (!output_root || !request_may_have_priority(request, job->priority) ||
        !submit_checks_folder(request, job, reading->root) || !find_inputs(request, &reading->paths, &inputs))
        return false;
    if (!submit_checks_targets(request, job) || !submit_checks_after(request, job) || !check_limits(request, job) ||
        !check_collisions(request, job, reading->root)) {
        job_inputs_finish(&inputs);
        return false;
    }
    submit = create_submit(request, reading);
    submit->output_root = output_root;
    submit->inputs = inputs;
    submit->claim = (struct output_claim){.files = {submit->row.root, &submit->path, &submit->frames, &submit->marks},
                                          .name = submit->row.name};
    if (job->output.existing == JOB_EXISTING_VERIFY)
        output_older_begin(&submit->older, &request->farm->jobs, &submit->claim.files, submit->facts.hash);
    submit->task.step = on_step;
    output_claims_add(request->farm, &submit->claim);
    submit->piece = (struct work_piece){.run = on_folder_run, .done = on_folder_done, .uid = submit->row.owner_uid};
    begin(submit);
    return true;
}

static void on_document_read(struct job_document *reading, bool was_read)
{
    struct request request = {
        .farm = reading->farm, .client = reading->client, .code = MESSAGE_CODE_PARAMS, .error = reading->error};

    if (!was_read) request_fail(&request, MESSAGE_CODE_INTERNAL, "the daemon stops: submit the job to the next one");
    if (!reading->ok || !begin_submit(&request, reading))
        answer_send_error(reading->answer, request.code, request.error.message);
}

// A shortage of the farm is no fault of the job.
static int code_of(int errnum, enum message_code fault)
{
    return error_is_shortage(errnum) ? MESSAGE_CODE_INTERNAL : fault;
}

static void on_folder_run(struct work_piece *piece)
{
    struct job_submit *submit = (struct job_submit *)((char *)piece - offsetof(struct job_submit, piece));
    int folder;

    for (size_t i = 0; i < submit->inputs.count; i++) {
        int reason = input_roots_check_opening(&submit->inputs.inputs[i], &submit->error);

        if (reason == 0) continue;
        submit->failure =
            reason == EXDEV || reason == ELOOP ? MESSAGE_CODE_NOT_ALLOWED : code_of(reason, MESSAGE_CODE_PARAMS);
        return;
    }
    folder = output_root_open_folder(&submit->path, submit->row.root, submit->output_root->id, true, &submit->error);
    if (folder >= 0) {
        if (submit->older.files) output_older_list(&submit->older, folder);
        close(folder);
        return;
    }
    submit->failure = code_of(errno, folder == OUTPUT_ROOT_AWAY ? MESSAGE_CODE_CONFLICT : MESSAGE_CODE_PARAMS);
    if (submit->failure != MESSAGE_CODE_INTERNAL) error_prefix(&submit->error, "output.path");
}

static struct store_op format_op(const struct job_submit *submit)
{
    struct store_op op = {.kind = STORE_ADD_JOB, .job = submit->row};

    op.job.name = xstrdup(submit->row.name);
    op.job.owner = xstrdup(submit->row.owner);
    op.job.root = xstrdup(submit->row.root);
    if (submit->row.is_paused) op.job.reason = xasprintf("paused by %s", submit->row.owner);
    return op;
}

static void end_checks(struct job_submit *submit)
{
    const char *trouble = committer_trouble(submit->farm->committer);
    struct store_op op;

    if (!submit->failure && !output_older_check(&submit->older, &submit->error))
        submit->failure = MESSAGE_CODE_CONFLICT;
    if (submit->failure) {
        refuse(submit, (enum message_code)submit->failure, submit->error.message);
        return;
    }
    if (trouble) {
        refuse(submit, MESSAGE_CODE_STORE, trouble);
        return;
    }
    submit->row.id = submit->farm->next_job_id++;
    op = format_op(submit);
    submit->row.document = NULL;
    committer_put(submit->farm->committer, COMMIT_OR_DROP, &op, 1, on_committed, submit);
}

static void on_folder_done(struct work_piece *piece, bool was_run)
{
    struct job_submit *submit = (struct job_submit *)((char *)piece - offsetof(struct job_submit, piece));

    (void)was_run; // it always is
    loop_turns_put(submit->farm->turns, &submit->task);
}

static bool on_step(struct loop_task *task)
{
    struct job_submit *submit = (struct job_submit *)((char *)task - offsetof(struct job_submit, task));
    bool has_more = submit->older.count > 0 && output_older_step(&submit->older, &submit->farm->jobs);

    if (!has_more) end_checks(submit);
    return has_more;
}

static struct job_record *queue_submit(struct job_submit *submit)
{
    struct farm *farm = submit->farm;
    struct store_job *row = &submit->row;
    uint64_t barred = pool_access_find_barred(farm, submit->user, submit->pool);
    struct job_record *record;

    output_claims_remove(farm, &submit->claim); // its files move into the record
    record = job_table_add(&farm->jobs, row->id, row->root, &submit->path);
    record->output_root = submit->output_root;
    record->name = row->name;
    record->owner = row->owner;
    record->owner_uid = row->owner_uid;
    record->submitted_ms = row->submitted_ms;
    record->inputs = submit->paths;
    submit->paths = (struct job_paths){0};
    record->code = submit->code;
    record->pool = submit->pool;
    record->facts = submit->facts;
    record->queued = queue_add_job(farm->queue, &(struct queue_job_params){.id = row->id,
                                                                           .owner_uid = row->owner_uid,
                                                                           .frames = &submit->frames,
                                                                           .priority = row->priority,
                                                                           .barred = barred,
                                                                           .is_paused = row->is_paused,
                                                                           .waits = row->waits,
                                                                           .order = &submit->order});
    shares_set_weight(farm, row->owner_uid, record->owner);
    record->sent_state = JOB_STATE_COUNT;
    root_life_note_job(farm, record);
    if (row->is_paused) record->reason = xasprintf("paused by %s", row->owner);
    row->name = row->owner = row->root = NULL;
    record->notes = submit->notes;
    submit->notes = (struct job_notes){0};
    record->notify = submit->notify;
    submit->notify = (struct job_notify){0};
    record->after = job_after_take(&submit->after);
    record->waits = row->waits;
    submit->code = submit->pool = NULL;
    return record;
}

static void write_warning(struct json_writer *value)
{
    json_write_key(value, "warnings");
    json_write_begin_array(value);
    json_write_string(value, "notify: whether the farm has these targets is not known yet: march-web has not said so "
                             "since the daemon's start");
    json_write_end_array(value);
}

static void on_committed(void *user, bool ok, const struct error *error)
{
    struct job_submit *submit = user;
    struct farm *farm = submit->farm;
    struct json_writer value = {0};
    struct job_record *record;
    struct log_subject subject;

    if (!ok) {
        refuse(submit, MESSAGE_CODE_STORE, error->message);
        return;
    }
    record = queue_submit(submit);
    worker_pool_note_job(farm->pool, record);
    subject = job_record_subject(record);
    log_about(LOG_INFO, &subject, "job %lld (\"%s\"): submitted by %s", (long long)record->id, record->name,
              record->owner);
    json_write_begin_object(&value);
    json_write_integer_member(&value, "id", record->id);
    if (record->notify.count > 0 && !farm->targets.is_known) write_warning(&value);
    json_write_end_object(&value);
    answer_send_result(submit->answer, &value);
    json_writer_finish(&value);
    submit_destroy(submit);
    farm_want_feed(farm);
    if (record->waits) after_desk_add(farm, record);
    job_life_note_change(farm, record);
}
