// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/job_wait.h"

#include "daemon/farm/farm.h"
#include "daemon/farm/pool_access.h"
#include "daemon/store/committer.h"
#include "daemon/workers/worker_pool.h"

const char *const job_wait_names[JOB_WAIT_COUNT] = {
    [JOB_WAIT_NONE] = "none",     [JOB_WAIT_SERVED] = "served", [JOB_WAIT_TURN] = "turn",
    [JOB_WAIT_WORKER] = "worker", [JOB_WAIT_POOL] = "pool",     [JOB_WAIT_OUTPUT] = "output",
    [JOB_WAIT_ROOT] = "root",     [JOB_WAIT_PAUSED] = "paused", [JOB_WAIT_DRAINED] = "drained",
    [JOB_WAIT_STORE] = "store",   [JOB_WAIT_JOBS] = "jobs",
};

struct job_wait_scene job_wait_look(const struct farm *farm)
{
    struct job_wait_scene scene = {.farm = farm, .pools = pool_access_all(farm)};
    int ready[TURNS_KIND_LIMIT];

    worker_pool_count_ready(farm->pool, ready);
    for (int kind = 0; kind < TURNS_KIND_LIMIT; kind++)
        scene.ready |= (uint64_t)(ready[kind] > 0) << kind;
    return scene;
}

// The order is that of job_view's reasons.
enum job_wait job_wait_find(const struct job_wait_scene *scene, const struct job_record *record)
{
    const struct queue_job *queued = record->queued;
    uint64_t barred = queued->turn.barred;

    if (queued->states.counts[FRAME_QUEUED] == 0 || !queue_job_is_live(queued)) return JOB_WAIT_NONE;
    if (queued->is_paused) return JOB_WAIT_PAUSED;
    if (queued->block == QUEUE_AWAY) return JOB_WAIT_ROOT;
    if (queued->wait != QUEUE_WAITS_NOT) return JOB_WAIT_JOBS;
    if (committer_trouble(scene->farm->committer)) return JOB_WAIT_STORE;
    if (scene->farm->drain.user) return JOB_WAIT_DRAINED;
    if (queued->states.counts[FRAME_RUNNING] > 0) return JOB_WAIT_SERVED;
    if (queued->block == QUEUE_IN_DOUBT) return JOB_WAIT_OUTPUT;
    if ((scene->pools & ~barred) == 0) return JOB_WAIT_POOL;
    return (scene->ready & ~barred) == 0 ? JOB_WAIT_WORKER : JOB_WAIT_TURN;
}

double job_wait_seconds(const struct job_wait_scene *scene, const struct job_record *record, int64_t clock_ms)
{
    int64_t since_ms = record->submitted_ms;

    if (record->queued->states.counts[FRAME_RUNNING] > 0) return 0;
    if (since_ms < scene->farm->started_ms) since_ms = scene->farm->started_ms;
    if (since_ms < record->served_ms) since_ms = record->served_ms;
    return clock_ms > since_ms ? (double)(clock_ms - since_ms) / 1000 : 0;
}
