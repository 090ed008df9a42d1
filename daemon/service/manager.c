// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/manager.h"

#include "core/base/alloc.h"
#include "daemon/farm/farm.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/committer.h"
#include "daemon/workers/worker_pool.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-daemon.h>

enum { LINE_SIZE = 512, INTERVAL_MS = 2000, WRITING_MS = 20000 };

struct manager {
    struct farm *farm; // borrowed; outlives us
    uv_timer_t timer;
    bool is_stopping;
    char status[LINE_SIZE];
};

static void on_interval(uv_timer_t *timer);

// Why an output root is away; NULL: none is. One for which jobs wait goes before one that only ended jobs have.
static const char *find_root_trouble(const struct farm *farm)
{
    for (size_t i = 0; i < farm->jobs.count; i++) {
        const struct job_record *job = farm->jobs.records[i];

        if (job->queued->block == QUEUE_AWAY && queue_job_is_live(job->queued)) return job->output_root->trouble;
    }
    for (size_t i = 0; i < farm->roots.count; i++)
        if (farm->roots.roots[i]->is_watched && !farm->roots.roots[i]->is_there) return farm->roots.roots[i]->trouble;
    return NULL;
}

// Why nothing, or less than all, is rendered; NULL: no reason. Owned by the caller.
static char *find_trouble(const struct manager *manager)
{
    const struct farm *farm = manager->farm;
    const char *store_trouble = committer_trouble(farm->committer), *root_trouble;
    char *trouble = manager->is_stopping ? NULL : worker_pool_format_trouble(farm->pool, NULL);

    if (store_trouble) {
        free(trouble);
        return xstrdup(store_trouble);
    }
    if (farm->drain.user && !manager->is_stopping) {
        free(trouble);
        return farm_format_drain(farm);
    }
    if (trouble) return trouble;
    root_trouble = find_root_trouble(farm);
    return root_trouble ? xstrdup(root_trouble) : NULL;
}

static void format_line(const struct manager *manager, char line[static LINE_SIZE])
{
    const struct queue *queue = manager->farm->queue;
    char *trouble = find_trouble(manager);
    int64_t jobs = 0;

    for (const struct queue_job *job = queue_first_job(queue); job; job = job->next)
        jobs += queue_job_is_live(job);
    snprintf(line, LINE_SIZE, "%sjobs: %" PRId64 "; frames: %" PRId64 " queued, %" PRId64 " running%s%s",
             manager->is_stopping ? "stopping; " : "", jobs, queue_count(queue, FRAME_QUEUED),
             queue_count(queue, FRAME_RUNNING), trouble ? "; " : "", trouble ? trouble : "");
    free(trouble);
    // A line feed would begin another assignment of the notification.
    for (char *at = line; *at; at++)
        if (*at == '\n') *at = ' ';
}

struct manager *manager_open(struct farm *farm)
{
    struct manager *manager = xcalloc(1, sizeof *manager);

    manager->farm = farm;
    uv_timer_init(farm->loop, &manager->timer);
    manager->timer.data = manager;
    if (getenv("NOTIFY_SOCKET")) uv_timer_start(&manager->timer, on_interval, INTERVAL_MS, INTERVAL_MS);
    return manager;
}

static void on_interval(uv_timer_t *timer)
{
    struct manager *manager = timer->data;
    char line[LINE_SIZE];

    format_line(manager, line);
    if (strcmp(line, manager->status) == 0) return;
    strcpy(manager->status, line);
    sd_notifyf(0, "STATUS=%s", line);
}

void manager_notify_ready(struct manager *manager)
{
    format_line(manager, manager->status);
    sd_notifyf(0, "READY=1\nSTATUS=%s", manager->status);
}

void manager_notify_reloading(const struct manager *manager)
{
    (void)manager;
    sd_notifyf(0, "RELOADING=1\nMONOTONIC_USEC=%" PRIu64, uv_hrtime() / 1000);
}

void manager_notify_stopping(struct manager *manager, int64_t timeout_ms)
{
    manager->is_stopping = true;
    format_line(manager, manager->status);
    sd_notifyf(0, "STOPPING=1\nSTATUS=%s\nEXTEND_TIMEOUT_USEC=%" PRId64, manager->status,
               (timeout_ms + WRITING_MS) * 1000);
}

static void on_closed(uv_handle_t *handle)
{
    free(handle->data);
}

void manager_close(struct manager *manager)
{
    uv_close((uv_handle_t *)&manager->timer, on_closed);
}
