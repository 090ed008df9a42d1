// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/root_life.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/output_root.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/job_life.h"
#include "daemon/output/sweeper.h"
#include "daemon/workers/worker_pool.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

enum { DOUBT_LIMIT = 3 };

struct output_check {
    struct farm *farm;         // borrowed; outlives us
    struct job_record *record; // held
    uv_work_t work;
    enum root_life_cause cause;
    char *why;                       // owned; NULL: none
    bool is_there, is_open, is_gone; // results: the root; the folder; the folder is missing
    struct error error;
};

static void on_check_run(uv_work_t *work);
static void on_check_done(uv_work_t *work, int status);

// Lets frames of the job be taken, or not, as its root and its check say.
static void settle(struct farm *farm, struct job_record *record)
{
    enum queue_block before = record->queued->block;
    enum queue_block after = !record->output_root->is_there ? QUEUE_AWAY
                             : record->is_output_checked    ? QUEUE_IN_DOUBT
                                                            : QUEUE_OPEN;

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
static void sweep_again(struct farm *farm, struct job_record *record)
{
    if (!record->needs_sweep) return;
    record->needs_sweep = false;
    if (!record->is_ending || record->is_sweeping || record->is_deleting) return;
    record->is_sweeping = true;
    sweeper_sweep_job(farm->sweeper, record);
}

void root_life_note_change(struct farm *farm, struct root *root)
{
    int jobs = 0;

    for (size_t i = 0; i < farm->jobs.count; i++) {
        struct job_record *record = farm->jobs.records[i];

        if (record->output_root != root) continue;
        jobs += queue_job_is_live(record->queued);
        settle(farm, record);
        if (root->is_there) sweep_again(farm, record);
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
    *check = (struct output_check){
        .farm = farm, .record = record, .cause = cause, .why = why ? xstrdup(why) : NULL, .work.data = check};
    job_record_hold(record);
    record->is_output_checked = true;
    farm->output_checks++;
    settle(farm, record);
    uv_queue_work(farm->loop, &check->work, on_check_run, on_check_done);
}

static void on_check_run(uv_work_t *work)
{
    struct output_check *check = work->data;
    const struct job_record *record = check->record;
    bool create = check->cause == ROOT_LIFE_FOLDER_WANTED;
    int fd = output_root_open_folder(&record->path, record->root, record->output_root->id, create, &check->error);

    check->is_there = fd != OUTPUT_ROOT_AWAY;
    check->is_gone = fd == -1 && errno == ENOENT;
    check->is_open = fd >= 0;
    if (fd >= 0) close(fd);
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

static void on_check_done(uv_work_t *work, int status)
{
    struct output_check *check = work->data;
    struct job_record *record = check->record;

    (void)status;
    check->farm->output_checks--;
    record->is_output_checked = false;
    if (!record->is_removed) {
        judge(check);
        settle(check->farm, record);
    }
    job_record_release(record);
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
