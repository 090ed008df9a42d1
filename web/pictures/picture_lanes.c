// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_lanes.h"

#include "core/base/alloc.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

// It is there while it has tasks.
struct lane {
    char *name; // owned
    struct lane_task *first, **end;
    size_t count;     // of those that wait
    bool is_busy;     // a thread runs one more
    int64_t begun_ms; // that one
    struct lane *next;
};

struct picture_lanes {
    struct picture_lanes_params params;
    pthread_mutex_t lock; // guards what follows
    pthread_cond_t changed, ended;
    struct lane *first; // owned; whose turn is next comes first
    size_t thread_count, idle_count, telling_count;
    bool is_stopped, is_left; // the last thread frees us
};

static int64_t now_ms(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

struct picture_lanes *picture_lanes_create(const struct picture_lanes_params *params)
{
    struct picture_lanes *lanes = xcalloc(1, sizeof *lanes);
    pthread_condattr_t attributes;

    lanes->params = *params;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_mutex_init(&lanes->lock, NULL);
    pthread_cond_init(&lanes->changed, NULL);
    pthread_cond_init(&lanes->ended, &attributes);
    pthread_condattr_destroy(&attributes);
    return lanes;
}

static void free_lanes(struct picture_lanes *lanes)
{
    pthread_cond_destroy(&lanes->ended);
    pthread_cond_destroy(&lanes->changed);
    pthread_mutex_destroy(&lanes->lock);
    free(lanes);
}

static bool is_ready(const struct lane *lane)
{
    return lane->first && !lane->is_busy;
}

// As the last one. What follows has the lock.
static void append(struct picture_lanes *lanes, struct lane *lane)
{
    struct lane **link = &lanes->first;

    while (*link)
        link = &(*link)->next;
    *link = lane;
    lane->next = NULL;
}

static void take_out(struct picture_lanes *lanes, const struct lane *lane)
{
    struct lane **link = &lanes->first;

    while (*link != lane)
        link = &(*link)->next;
    *link = lane->next;
}

static void free_lane(struct lane *lane)
{
    free(lane->name);
    free(lane);
}

static struct lane *find_or_add(struct picture_lanes *lanes, const char *name)
{
    struct lane *lane = lanes->first;

    while (lane && strcmp(lane->name, name) != 0)
        lane = lane->next;
    if (lane) return lane;
    lane = xcalloc(1, sizeof *lane);
    lane->name = xstrdup(name);
    lane->end = &lane->first;
    append(lanes, lane);
    return lane;
}

static struct lane *find_ready(const struct picture_lanes *lanes)
{
    struct lane *lane = lanes->first;

    while (lane && !is_ready(lane))
        lane = lane->next;
    return lane;
}

static struct lane_task *take(struct lane *lane)
{
    struct lane_task *task = lane->first;

    lane->first = task->next;
    if (!lane->first) lane->end = &lane->first;
    lane->count--;
    return task;
}

// Its turn comes again after that of the others.
static void end_turn(struct picture_lanes *lanes, struct lane *lane)
{
    lane->is_busy = false;
    take_out(lanes, lane);
    if (lane->first)
        append(lanes, lane);
    else
        free_lane(lane);
}

static void run_next(struct picture_lanes *lanes, struct lane *lane)
{
    struct lane_task *task = take(lane);
    bool is_told;

    lane->is_busy = true;
    lane->begun_ms = now_ms();
    pthread_mutex_unlock(&lanes->lock);
    lanes->params.run(task);
    pthread_mutex_lock(&lanes->lock);
    end_turn(lanes, lane);
    is_told = !lanes->is_stopped;
    lanes->telling_count += is_told;
    pthread_mutex_unlock(&lanes->lock);
    if (is_told)
        lanes->params.done(task, lanes->params.user);
    else
        lanes->params.release(task);
    pthread_mutex_lock(&lanes->lock);
    lanes->telling_count -= is_told;
}

static void *run_thread(void *user)
{
    struct picture_lanes *lanes = user;
    bool is_last;

    pthread_mutex_lock(&lanes->lock);
    while (!lanes->is_stopped) {
        struct lane *lane = find_ready(lanes);

        if (lane) {
            run_next(lanes, lane);
        } else {
            lanes->idle_count++;
            pthread_cond_wait(&lanes->changed, &lanes->lock);
            lanes->idle_count--;
        }
    }
    is_last = --lanes->thread_count == 0 && lanes->is_left;
    pthread_cond_signal(&lanes->ended);
    pthread_mutex_unlock(&lanes->lock);
    if (is_last) free_lanes(lanes);
    return NULL;
}

// Signals are the loop's matter. Nobody joins a thread that may not end.
static bool start_thread(struct picture_lanes *lanes)
{
    sigset_t all, before;
    pthread_t thread;
    int cause;

    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    cause = pthread_create(&thread, NULL, run_thread, lanes);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (cause) return false;
    pthread_detach(thread);
    lanes->thread_count++;
    return true;
}

// A thread for each lane that could go on, as far as there may be so many.
static void start_threads(struct picture_lanes *lanes)
{
    size_t ready = 0;

    for (const struct lane *lane = lanes->first; lane; lane = lane->next)
        ready += is_ready(lane);
    if (ready > lanes->idle_count && lanes->thread_count < LANE_THREAD_LIMIT) (void)start_thread(lanes);
}

static void drop_if_empty(struct picture_lanes *lanes, struct lane *lane)
{
    if (lane->first || lane->is_busy) return;
    take_out(lanes, lane);
    free_lane(lane);
}

static enum lane_entry enter(struct picture_lanes *lanes, struct lane *lane, struct lane_task *task)
{
    if (lanes->is_stopped || lane->count >= LANE_WAIT_LIMIT) return LANE_FULL;
    if (lane->is_busy && now_ms() - lane->begun_ms > lanes->params.late_ms) return LANE_LATE;
    if (lanes->thread_count == 0 && !start_thread(lanes)) return LANE_FULL;
    task->next = NULL;
    *lane->end = task;
    lane->end = &task->next;
    lane->count++;
    start_threads(lanes);
    pthread_cond_signal(&lanes->changed);
    return LANE_ENTERED;
}

enum lane_entry picture_lanes_add(struct picture_lanes *lanes, const char *name, struct lane_task *task)
{
    enum lane_entry entry;
    struct lane *lane;

    pthread_mutex_lock(&lanes->lock);
    lane = find_or_add(lanes, name);
    entry = enter(lanes, lane, task);
    drop_if_empty(lanes, lane);
    pthread_mutex_unlock(&lanes->lock);
    return entry;
}

// Those that are busy stay, for their threads.
static void release_waiting(struct picture_lanes *lanes)
{
    for (struct lane *lane = lanes->first; lane; lane = lane->next)
        while (lane->first)
            lanes->params.release(take(lane));
    for (struct lane *lane = lanes->first, *next; lane; lane = next) {
        next = lane->next;
        drop_if_empty(lanes, lane);
    }
}

// What is being told is waited for without a limit: it hangs on no disk.
static void wait_for_threads(struct picture_lanes *lanes)
{
    struct timespec until;
    int cause = 0;

    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += LANE_PATIENCE_MS / 1000;
    while (lanes->thread_count > 0 && (cause != ETIMEDOUT || lanes->telling_count > 0))
        cause = lanes->telling_count > 0 && cause == ETIMEDOUT
                    ? pthread_cond_wait(&lanes->ended, &lanes->lock)
                    : pthread_cond_timedwait(&lanes->ended, &lanes->lock, &until);
}

void picture_lanes_stop(struct picture_lanes *lanes)
{
    bool is_left;

    pthread_mutex_lock(&lanes->lock);
    lanes->is_stopped = true;
    pthread_cond_broadcast(&lanes->changed);
    release_waiting(lanes);
    wait_for_threads(lanes);
    is_left = lanes->is_left = lanes->thread_count > 0;
    pthread_mutex_unlock(&lanes->lock);
    if (!is_left) free_lanes(lanes);
}
