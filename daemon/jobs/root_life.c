// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/root_life.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/output_path.h"
#include "core/job/output_root.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/events.h"
#include "daemon/jobs/job_life.h"
#include "daemon/jobs/root_desks.h"
#include "daemon/loop/work_desk.h"
#include "daemon/output/intent.h"
#include "daemon/output/sweeper.h"
#include "daemon/workers/worker_pool.h"

#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

enum { DOUBT_LIMIT = 3 };

struct output_check {
    struct farm *farm;         // borrowed; outlives us
    struct job_record *record; // held
    struct work_piece piece;
    enum root_life_cause cause;
    char *why;                   // owned; NULL: none
    struct store_frame *intents; // owned
    size_t intent_count;         // the first `published_count` are published, once the folder was open
    size_t published_count;
    bool is_there, is_open, is_gone; // results: the root; the folder; the folder is missing
    struct error error;
};

static void on_check_run(struct work_piece *piece);
static void on_check_done(struct work_piece *piece, bool was_run);

// Lets frames of the job be taken, or not, as its root and its check say.
static void settle(struct farm *farm, struct job_record *record)
{
    enum queue_block before = record->queued->block;
    bool is_in_doubt = record->is_output_checked || record->intent_count > 0;
    enum queue_block after = !record->output_root->is_there ? QUEUE_AWAY : is_in_doubt ? QUEUE_IN_DOUBT : QUEUE_OPEN;

    if (before == after) return;
    queue_set_block(farm->queue, record->queued, after);
    if (before == QUEUE_OPEN) worker_pool_drop_job(farm->pool, record->id, false);
    if (after == QUEUE_OPEN) farm_want_feed(farm);
    if (before == QUEUE_AWAY || after == QUEUE_AWAY) job_life_note_change(farm, record);
}

void root_life_note_job(struct farm *farm, struct job_record *record)
{
    if (!record->output_root->is_there) queue_set_block(farm->queue, record->queued, QUEUE_AWAY);
}

// A job that was revived since is swept at its next end.
void root_life_sweep_again(struct farm *farm, struct job_record *record)
{
    if (!record->is_ending) record->needs_sweep = false;
    if (!record->needs_sweep || !record->output_root->is_there || record->is_sweeping || record->is_deleting) return;
    record->is_sweeping = true; // it needs that until it is done: a crash may come before
    sweeper_sweep_job(farm->sweeper, record);
}

// Frames whose files may have got their names are settled before others are taken.
static void check_intents(struct farm *farm, struct job_record *record)
{
    if (record->intent_count > 0) root_life_check(farm, record, ROOT_LIFE_ROOT_BACK, NULL);
}

void root_life_note_change(struct farm *farm, struct root *root)
{
    int jobs = 0;

    for (size_t i = 0; i < farm->jobs.count; i++) {
        struct job_record *record = farm->jobs.records[i];

        if (record->output_root != root) continue;
        jobs += queue_job_is_live(record->queued);
        if (root->is_there) check_intents(farm, record);
        settle(farm, record);
        root_life_sweep_again(farm, record);
    }
    if (root->is_there)
        log_info("output root %s is there; jobs that go on: %d", root->path, jobs);
    else
        log_warn("%s; jobs that wait until it is back: %d", root->trouble, jobs);
}

void root_life_lose(struct farm *farm, struct root *root, const char *why)
{
    bool was_there = root->is_there;

    root_set_trouble(root, why);
    if (was_there) root_life_note_change(farm, root);
}

void root_life_check(struct farm *farm, struct job_record *record, enum root_life_cause cause, const char *why)
{
    struct output_check *check;

    if (record->is_output_checked || !queue_job_is_live(record->queued)) return;
    check = xcalloc(1, sizeof *check);
    *check = (struct output_check){.farm = farm,
                                   .record = record,
                                   .cause = cause,
                                   .why = why ? xstrdup(why) : NULL,
                                   .intents = record->intents,
                                   .intent_count = record->intent_count,
                                   .piece = {.run = on_check_run, .done = on_check_done, .uid = record->owner_uid}};
    record->intents = NULL;
    record->intent_count = record->intent_capacity = 0;
    job_record_hold(record);
    record->is_output_checked = true;
    farm->output_checks++;
    settle(farm, record);
    root_desks_put(farm->root_desks, record->output_root, &check->piece);
}

static void settle_intents(struct output_check *check, int folder_fd)
{
    for (size_t i = 0; i < check->intent_count; i++) {
        const struct store_frame row = check->intents[i];

        if (!intent_settle(check->record, &row, check->farm->id, folder_fd)) continue;
        check->intents[i] = check->intents[check->published_count];
        check->intents[check->published_count++] = row;
    }
}

static struct output_check *check_of(struct work_piece *piece)
{
    return (struct output_check *)((char *)piece - offsetof(struct output_check, piece));
}

static void on_check_run(struct work_piece *piece)
{
    struct output_check *check = check_of(piece);
    const struct job_record *record = check->record;
    bool create = check->cause == ROOT_LIFE_FOLDER_WANTED;
    int root_fd = output_root_open(record->root, record->output_root->id, &check->error), fd = -1;

    if (root_fd >= 0) fd = output_path_open_below(&record->path, root_fd, record->root, create, &check->error);
    check->is_gone = root_fd >= 0 && fd < 0 && errno == ENOENT;
    check->is_open = fd >= 0;
    if (fd >= 0) settle_intents(check, fd);
    check->is_there = root_fd >= 0 && output_root_is_at(root_fd, record->root);
    if (root_fd >= 0 && !check->is_there) error_set(&check->error, "output root %s was taken away", record->root);
    if (fd >= 0) close(fd);
    if (root_fd >= 0) close(root_fd);
}

static void note_published(struct farm *farm, struct job_record *record, const struct store_frame *row)
{
    const struct queue_ticket ticket = {.job = record->id,
                                        .frame = frame_range_at(&record->queued->frames, row->index),
                                        .index = row->index,
                                        .attempt = row->attempts};
    struct store_op op = {.kind = STORE_SET_FRAME, .frame = *row};

    if (frame_accuracy_is_over(&row->accuracy, record->facts.tolerance)) queue_note_missed(record->queued, row->index);
    op.frame.state = FRAME_SUCCEEDED;
    farm_store(farm, op);
    record->disk_bytes += (int64_t)row->size_bytes;
    events_send_frame(farm->events, &ticket, FRAME_SUCCEEDED, NULL);
}

static void log_intent(const struct job_record *record, const struct store_frame *row, bool is_published)
{
    struct log_subject subject = job_record_subject(record);

    subject.frame = frame_range_at(&record->queued->frames, row->index);
    subject.attempt = row->attempts;
    log_about(LOG_INFO, &subject, "job %lld frame %d: its file was being published when the root went away: now %s",
              (long long)record->id, subject.frame, is_published ? "published" : "queued again");
}

// Takes the outcome of the intents, or keeps them where it is still unknown.
static void take_intents(struct output_check *check)
{
    struct job_record *record = check->record;
    bool is_known = check->is_there && (check->is_open || check->is_gone);

    for (size_t i = 0; i < check->intent_count; i++) {
        const struct store_frame *row = &check->intents[i];

        if (!is_known && queue_job_is_live(record->queued))
            job_record_keep_intent(record, row);
        else if (is_known && i < check->published_count && queue_find_published(record->queued, row->index))
            note_published(check->farm, record, row);
        else
            farm_store(check->farm, store_op_reset_frame(record->id, row->index));
        if (is_known) log_intent(record, row, i < check->published_count);
    }
}

static void hold(struct farm *farm, struct job_record *record, const char *what)
{
    char *why = xasprintf("output: %s", what);

    job_life_hold(farm, record, why);
    free(why);
}

static void judge(const struct output_check *check)
{
    struct farm *farm = check->farm;
    struct job_record *record = check->record;

    if (!check->is_there) {
        root_life_lose(farm, record->output_root, check->error.message);
    } else if (check->is_gone) {
        char *what = xasprintf("folder %s/%s is gone: march resume makes it again", record->root, record->path.folder);

        hold(farm, record, what);
        free(what);
    } else if (!check->is_open) {
        hold(farm, record, check->error.message);
    } else if (check->cause == ROOT_LIFE_OUTPUT_FAILED ||
               (check->cause == ROOT_LIFE_ROOT_FAILED && ++record->root_doubts >= DOUBT_LIMIT)) {
        record->root_doubts = 0;
        hold(farm, record, check->why);
    }
}

static void on_check_done(struct work_piece *piece, bool was_run)
{
    struct output_check *check = check_of(piece);
    struct job_record *record = check->record;

    (void)was_run; // it always is
    check->farm->output_checks--;
    record->is_output_checked = false;
    if (!record->is_removed) {
        take_intents(check);
        judge(check);
        if (check->is_open && record->output_root->is_there) check_intents(check->farm, record);
        settle(check->farm, record);
        if (check->published_count > 0) job_life_note_change(check->farm, record);
    }
    job_record_release(record);
    free(check->intents);
    free(check->why);
    free(check);
}

void root_life_refuse(struct farm *farm, struct job_record *record, enum retry_fault fault, const char *why)
{
    if (fault == RETRY_FAULT_ROOT)
        root_life_check(farm, record, ROOT_LIFE_ROOT_FAILED, why);
    else if (fault == RETRY_FAULT_OUTPUT)
        root_life_check(farm, record, ROOT_LIFE_OUTPUT_FAILED, why);
    else
        job_life_refuse(farm, record, fault == RETRY_FAULT_JOB, why);
}
