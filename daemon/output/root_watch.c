// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/root_watch.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/output/root_look.h"
#include "daemon/settings/options.h"

#include <stdlib.h>
#include <string.h>

enum { LOOK_MS = 1000, FOLDER_LIMIT = 16 };

struct root_watch {
    struct farm *farm; // borrowed; outlives us
    root_watch_on_change *on_change;
    uv_timer_t timer;
    bool is_closed;
};

struct root_task {
    struct root_watch *watch; // borrowed; outlives us
    struct root *root;        // borrowed; outlives us
    uv_work_t work;
    struct root_look look;
};

static void on_timer(uv_timer_t *timer);
static void on_look_run(uv_work_t *work);
static void on_look_done(uv_work_t *work, int status);

struct root_watch *root_watch_create(struct farm *farm, root_watch_on_change *on_change)
{
    struct root_watch *watch = xcalloc(1, sizeof *watch);

    watch->farm = farm;
    watch->on_change = on_change;
    uv_timer_init(farm->loop, &watch->timer);
    watch->timer.data = watch;
    uv_timer_start(&watch->timer, on_timer, LOOK_MS, LOOK_MS);
    return watch;
}

void root_watch_close(struct root_watch *watch)
{
    if (!watch) return;
    watch->is_closed = true;
    uv_close((uv_handle_t *)&watch->timer, NULL);
}

void root_watch_destroy(struct root_watch *watch)
{
    free(watch);
}

// A root without an id has no marker yet: the folders of its jobs tell it from the folder below its mount point.
static struct root_look make_look(const struct farm *farm, const struct root *root)
{
    struct root_look look = {.path = root->path, .farm = farm->id, .state_folder = farm->options->state_folder};

    memcpy(look.id, root->id, sizeof look.id);
    if (root->id[0]) return look;
    look.folders = xcalloc(FOLDER_LIMIT, sizeof look.folders[0]);
    for (size_t i = 0; i < farm->jobs.count && look.folder_count < FOLDER_LIMIT; i++) {
        const struct job_record *record = farm->jobs.records[i];

        if (record->output_root == root && record->queued->states.counts[FRAME_SUCCEEDED] > 0)
            look.folders[look.folder_count++] = xstrdup(record->path.folder);
    }
    return look;
}

static void finish_look(struct root_look *look)
{
    for (size_t i = 0; i < look->folder_count; i++)
        free(look->folders[i]);
    free(look->folders);
}

// Brings what was seen into the table and the log. True when the root has got its id.
static bool take_look(struct root *root, const struct root_look *look)
{
    bool is_new = look->is_there && !root->id[0];

    if (look->is_unknown && root->is_there) return false;
    if (!look->is_there) {
        root_set_trouble(root, look->error.message);
        return false;
    }
    if (look->was_marked)
        log_info("output root %s: marked as an output root of this farm, by " ROOT_MARKER_NAME " in it", root->path);
    if (is_new) memcpy(root->id, look->id, sizeof root->id);
    root_set_place(root, &look->place);
    return is_new;
}

bool root_watch_look(struct farm *farm, struct root *root)
{
    struct root_look look = make_look(farm, root);
    bool is_new;

    root_look_run(&look);
    is_new = take_look(root, &look);
    finish_look(&look);
    return is_new;
}

struct store_op root_watch_format_op(const struct root *root)
{
    return (struct store_op){.kind = STORE_SET_ROOT, .root = {xstrdup(root->path), xstrdup(root->id)}};
}

static void start_look(struct root_watch *watch, struct root *root)
{
    struct root_task *task = xcalloc(1, sizeof *task);

    task->watch = watch;
    task->root = root;
    task->work.data = task;
    task->look = make_look(watch->farm, root);
    root->is_being_looked_at = true;
    uv_queue_work(watch->farm->loop, &task->work, on_look_run, on_look_done);
}

// A root that hangs, such as one on a server that does not answer, is looked at by one thread only.
static void on_timer(uv_timer_t *timer)
{
    struct root_watch *watch = timer->data;
    const struct queue *queue = watch->farm->queue;
    bool has_work = queue_count(queue, FRAME_QUEUED) > 0 || queue_count(queue, FRAME_RUNNING) > 0;
    const struct root_table *table = &watch->farm->roots;

    for (size_t i = 0; i < table->count; i++) {
        struct root *root = table->roots[i];

        if (root->is_watched && !root->is_being_looked_at && (has_work || !root->is_there)) start_look(watch, root);
    }
}

static void on_look_run(uv_work_t *work)
{
    struct root_task *task = work->data;

    root_look_run(&task->look);
}

static void on_look_done(uv_work_t *work, int status)
{
    struct root_task *task = work->data;
    struct farm *farm = task->watch->farm;
    struct root *root = task->root;
    bool was_there = root->is_there;

    (void)status;
    root->is_being_looked_at = false;
    if (!task->watch->is_closed) {
        if (take_look(root, &task->look)) farm_store(farm, root_watch_format_op(root));
        if (root->is_there != was_there) task->watch->on_change(farm, root);
    }
    finish_look(&task->look);
    free(task);
}
