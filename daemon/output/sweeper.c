// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/sweeper.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/output_path.h"
#include "core/job/output_root.h"
#include "daemon/farm/job_table.h"

#include <assert.h>
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct sweep_task {
    struct job_record *record;   // borrowed; outlives us
    char part[OUTPUT_NAME_SIZE]; // empty: all part files of the job
    bool was_away;               // result
    struct sweep_task *next;     // on the lane's queue
};

// What is swept in one output root: one that hangs holds up itself.
struct sweep_lane {
    struct sweeper *sweeper;
    const struct root *root; // borrowed; outlives us
    uv_work_t work;
    struct sweep_task *first, *last; // waiting tasks; the working thread uses `in_flight`
    struct sweep_task *in_flight;
    struct sweep_lane *next; // on the sweeper's list
};

struct sweeper {
    uv_loop_t *loop;  // borrowed; outlives us
    const char *farm; // borrowed; outlives us; the farm's id
    sweeper_on_done *on_swept;
    void *user;               // borrowed
    struct sweep_lane *lanes; // owned
};

static void start_next(struct sweep_lane *lane);
static void on_sweep_run(uv_work_t *work);
static void on_sweep_done(uv_work_t *work, int status);

struct sweeper *sweeper_create(uv_loop_t *loop, const char *farm, sweeper_on_done *on_swept, void *user)
{
    struct sweeper *sweeper = xcalloc(1, sizeof *sweeper);

    sweeper->loop = loop;
    sweeper->farm = farm;
    sweeper->on_swept = on_swept;
    sweeper->user = user;
    return sweeper;
}

void sweeper_destroy(struct sweeper *sweeper)
{
    struct sweep_lane *lane;

    if (!sweeper) return;
    assert(sweeper_is_idle(sweeper));
    while ((lane = sweeper->lanes)) {
        sweeper->lanes = lane->next;
        free(lane);
    }
    free(sweeper);
}

bool sweeper_is_idle(const struct sweeper *sweeper)
{
    const struct sweep_lane *lane = sweeper->lanes;

    while (lane && !lane->in_flight)
        lane = lane->next;
    return !lane;
}

static struct sweep_lane *find_lane(struct sweeper *sweeper, const struct root *root)
{
    struct sweep_lane *lane = sweeper->lanes;

    while (lane && lane->root != root)
        lane = lane->next;
    if (lane) return lane;
    lane = xcalloc(1, sizeof *lane);
    *lane = (struct sweep_lane){.sweeper = sweeper, .root = root, .next = sweeper->lanes};
    lane->work.data = lane;
    return sweeper->lanes = lane;
}

static void add_task(struct sweeper *sweeper, struct sweep_task *task)
{
    struct sweep_lane *lane = find_lane(sweeper, task->record->output_root);

    if (lane->last)
        lane->last->next = task;
    else
        lane->first = task;
    lane->last = task;
    start_next(lane);
}

void sweeper_remove_part(struct sweeper *sweeper, const struct job_record *record, int32_t frame, int64_t epoch,
                         int attempt)
{
    struct sweep_task *task = xcalloc(1, sizeof *task);
    const struct output_part part = {
        .farm = sweeper->farm, .job = record->id, .epoch = epoch, .frame = frame, .attempt = attempt};

    task->record = (struct job_record *)record;
    output_path_format_part(&record->path, &part, task->part);
    add_task(sweeper, task);
}

void sweeper_sweep_job(struct sweeper *sweeper, struct job_record *record)
{
    struct sweep_task *task = xcalloc(1, sizeof *task);

    task->record = record;
    add_task(sweeper, task);
}

static void start_next(struct sweep_lane *lane)
{
    if (lane->in_flight || !lane->first) return;
    lane->in_flight = lane->first;
    lane->first = lane->in_flight->next;
    if (!lane->first) lane->last = NULL;
    uv_queue_work(lane->sweeper->loop, &lane->work, on_sweep_run, on_sweep_done);
}

bool sweeper_is_part_of(const struct job_record *record, const char *farm, const char *name)
{
    struct output_part part;

    return output_path_read_part(&record->path, farm, name, &part) && part.job == record->id;
}

static void remove_parts(const struct job_record *record, const char *farm, int folder)
{
    DIR *entries = fdopendir(folder);
    struct dirent *entry;

    if (!entries) {
        close(folder);
        return;
    }
    while ((entry = readdir(entries))) {
        if (sweeper_is_part_of(record, farm, entry->d_name)) unlinkat(folder, entry->d_name, 0);
    }
    closedir(entries);
}

static void on_sweep_run(uv_work_t *work)
{
    const struct sweep_lane *lane = work->data;
    struct sweep_task *task = lane->in_flight;
    const struct job_record *record = task->record;
    int folder = output_root_open_folder(&record->path, record->root, record->output_root->id, false, NULL);

    task->was_away = folder == OUTPUT_ROOT_AWAY;
    if (folder < 0) return;
    if (!task->part[0]) {
        remove_parts(record, lane->sweeper->farm, folder);
        return;
    }
    unlinkat(folder, task->part, 0);
    close(folder);
}

static void on_sweep_done(uv_work_t *work, int status)
{
    struct sweep_lane *lane = work->data;
    const struct sweeper *sweeper = lane->sweeper;
    struct sweep_task *task = lane->in_flight;

    lane->in_flight = NULL;
    start_next(lane);
    if (!task->part[0]) sweeper->on_swept(sweeper->user, task->record, task->was_away);
    free(task);
}
