// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/job_etas.h"

#include "core/base/alloc.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/pool_access.h"
#include "daemon/schedule/eta.h"
#include "daemon/settings/options.h"
#include "daemon/workers/worker_pool.h"

#include <math.h>
#include <stdlib.h>

// Jobs of one owner and priority that the same workers may render.
struct eta_lane {
    const struct turns_owner *owner; // borrowed; outlives us
    int priority;
    uint64_t barred;
    int workers; // that may render them; at least 1
    size_t first, count;
    double seconds; // that all of them take; infinite: unknown
};

struct eta_place {
    int64_t id;
    double seconds; // of this job and those of its lane before it; infinite: unknown
};

void job_etas_finish(struct job_etas *etas)
{
    free(etas->lanes);
    free(etas->places);
    *etas = (struct job_etas){0};
}

static int count_workers(const struct farm *farm, const struct queue_job *job)
{
    int workers = worker_pool_usable_count(farm->pool, job->turn.barred);

    return workers > 0 ? workers : 1;
}

// Negative: unknown.
static double find_own_s(struct job_record *record, int workers)
{
    const struct queue_job *queued = record->queued;
    int64_t left = queued->states.counts[FRAME_QUEUED] + queued->states.counts[FRAME_RUNNING];

    return estimate_eta_s(&record->estimate, frame_range_count(&queued->frames), left, workers);
}

static bool is_of_lane(const struct eta_lane *lane, const struct queue_job *job)
{
    return lane->owner == job->turn.owner && lane->priority == job->priority && lane->barred == job->turn.barred;
}

static struct eta_lane *add_lane(struct job_etas *etas, const struct farm *farm, const struct queue_job *job)
{
    struct eta_lane *lane;

    etas->lanes = xgrow(etas->lanes, &etas->lane_capacity, etas->lane_count + 1, sizeof etas->lanes[0]);
    lane = &etas->lanes[etas->lane_count++];
    *lane = (struct eta_lane){.owner = job->turn.owner,
                              .priority = job->priority,
                              .barred = job->turn.barred,
                              .workers = count_workers(farm, job),
                              .first = etas->place_count};
    return lane;
}

static void fill(struct job_etas *etas, const struct farm *farm)
{
    struct eta_lane *lane = NULL;

    etas->is_filled = true;
    for (const struct queue_job *job = NULL; (job = queue_next_ready(farm->queue, job));) {
        double seconds;

        if (!lane || !is_of_lane(lane, job)) lane = add_lane(etas, farm, job);
        seconds = find_own_s(job_table_find(&farm->jobs, job->id), lane->workers);
        lane->seconds += seconds >= 0 ? seconds : HUGE_VAL;
        lane->count++;
        etas->places = xgrow(etas->places, &etas->place_capacity, etas->place_count + 1, sizeof etas->places[0]);
        etas->places[etas->place_count++] = (struct eta_place){.id = job->id, .seconds = lane->seconds};
    }
}

// Of the lane's jobs before that one.
static double find_before_s(const struct job_etas *etas, const struct eta_lane *lane, int64_t id)
{
    const struct eta_place *places = &etas->places[lane->first];
    size_t low = 0, high = lane->count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;

        if (places[middle].id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low > 0 ? places[low - 1].seconds : 0;
}

static void add_rival(struct eta_rival *rivals, size_t *count, const struct eta_lane *lane)
{
    size_t i = 0;

    while (i < *count && rivals[i].owner != lane->owner)
        i++;
    if (i == *count) rivals[(*count)++] = (struct eta_rival){.owner = lane->owner};
    rivals[i].seconds += lane->seconds;
}

// `own_s`: of the job alone.
static double find_among_s(const struct job_etas *etas, const struct farm *farm, const struct queue_job *job,
                           double own_s, int workers)
{
    struct eta_rival *rivals = xcalloc(etas->lane_count + 1, sizeof rivals[0]);
    struct eta_params params = {.own_s = own_s,
                                .owner = job->turn.owner,
                                .rivals = rivals,
                                .workers = workers,
                                .half_life_s = (double)farm->options->half_life_ms / 1000};
    double eta_s;

    for (size_t i = 0; i < etas->lane_count && etas->lanes[i].priority >= job->priority; i++) {
        const struct eta_lane *lane = &etas->lanes[i];

        if ((pool_access_all(farm) & ~lane->barred & ~job->turn.barred) == 0) continue; // they share no workers
        if (lane->priority > job->priority)
            params.front_s += lane->seconds;
        else if (lane->owner == job->turn.owner)
            params.own_s += find_before_s(etas, lane, job->id);
        else
            add_rival(rivals, &params.rival_count, lane);
    }
    eta_s = isfinite(params.front_s + params.own_s) ? eta_find_s(&params) : -1;
    free(rivals);
    return eta_s;
}

// Negative: no job of its lane has frames to take.
static int find_lane_workers(const struct job_etas *etas, const struct queue_job *job)
{
    for (size_t i = 0; i < etas->lane_count; i++)
        if (is_of_lane(&etas->lanes[i], job)) return etas->lanes[i].workers;
    return -1;
}

double job_etas_find_s(struct job_etas *etas, const struct farm *farm, struct job_record *record)
{
    const struct queue_job *job = record->queued;
    int workers = find_lane_workers(etas, job);
    double own_s;

    if (workers < 0) workers = count_workers(farm, job);
    own_s = find_own_s(record, workers);
    if (own_s < 0 || job->states.counts[FRAME_QUEUED] == 0 || queue_job_state(job) == JOB_PAUSED) return own_s;
    if (!etas->is_filled) fill(etas, farm);
    return find_among_s(etas, farm, job, own_s, workers);
}
