// Frames per second through queue and dispatch on one core, and the memory of a million queued frames.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/clock.h"
#include "daemon/schedule/dispatch.h"
#include "daemon/schedule/estimate.h"
#include "daemon/schedule/queue.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FRAME_COUNT = 1000 * 1000, WORKERS = 2, MAX_ATTEMPTS = 3 };

static double resident_mib(void)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");

    if (!file || fscanf(file, "%*d %ld", &pages) != 1) pages = 0;
    if (file) fclose(file);
    return (double)pages * (double)sysconf(_SC_PAGESIZE) / (1024 * 1024);
}

static void print_row(const char *what, double seconds, const char *target)
{
    printf("%-54s %9.3f %12.0f   %s\n", what, seconds, FRAME_COUNT / seconds, target);
}

static void add_job(struct queue *queue, int64_t id, int64_t owner, const char *frames)
{
    struct frame_range range = {0};

    if (!frame_range_parse(&range, frames, NULL)) abort();
    queue_add_job(queue, &(struct queue_job_params){.id = id, .owner_uid = owner, .frames = &range, .priority = 50});
}

// Takes and publishes every frame, as the daemon does.
static void run_all(struct queue *queue, double frame_s)
{
    struct queue_ticket tickets[DISPATCH_CHUNK_LIMIT];
    struct estimate estimate = {0};

    for (struct queue_job *job; (job = queue_choose_job(queue, NULL));) {
        const struct dispatch_load load = {
            .frame_s = estimate_median_s(&estimate), .left = job->states.counts[FRAME_QUEUED], .workers = WORKERS};
        size_t count = queue_take(job, 1, tickets, dispatch_count(&load));

        for (size_t i = 0; i < count; i++) {
            if (!queue_begin_publish(queue, &tickets[i])) abort();
            if (!queue_succeed(queue, &tickets[i])) abort();
            estimate_add(&estimate, frame_s);
        }
    }
    if (queue_count(queue, FRAME_SUCCEEDED) != FRAME_COUNT) abort();
}

static void measure(const char *what, const char *frames, double frame_s)
{
    struct queue *queue = queue_create(MAX_ATTEMPTS);
    double start;

    add_job(queue, 1, 0, frames);
    start = clock_now_s();
    run_all(queue, frame_s);
    print_row(what, clock_now_s() - start, ">= 500000/s");
    queue_destroy(queue);
}

// Every frame fails twice before it succeeds.
static void measure_retries(void)
{
    struct queue *queue = queue_create(MAX_ATTEMPTS);
    struct queue_ticket tickets[DISPATCH_CHUNK_LIMIT];
    double start;

    add_job(queue, 1, 0, "0-999999");
    start = clock_now_s();
    for (struct queue_job *job; (job = queue_choose_job(queue, NULL));) {
        size_t count = queue_take(job, 1, tickets, DISPATCH_CHUNK_LIMIT);

        for (size_t i = 0; i < count; i++)
            if (tickets[i].attempt < MAX_ATTEMPTS)
                queue_fail(queue, &tickets[i], false, NULL);
            else
                queue_succeed(queue, &tickets[i]);
    }
    print_row("frames that fail twice, then succeed", clock_now_s() - start, "");
    if (queue_count(queue, FRAME_SUCCEEDED) != FRAME_COUNT) abort();
    queue_destroy(queue);
}

static void measure_jobs(void)
{
    enum { JOBS = 100 * 1000 };
    struct queue *queue = queue_create(MAX_ATTEMPTS);
    double start = clock_now_s();
    char what[80];

    for (int64_t id = 1; id <= JOBS; id++)
        add_job(queue, id, 0, "0-9");
    run_all(queue, 0.001);
    snprintf(what, sizeof what, "%d jobs of %d frames, adding included", JOBS, FRAME_COUNT / JOBS);
    print_row(what, clock_now_s() - start, ">= 500000/s");
    queue_destroy(queue);
}

// One decision a frame: whose turn it is, among the owners of 10,000 jobs.
static void measure_decisions(int owners)
{
    enum { JOBS = 10 * 1000 };
    struct queue *queue = queue_create(MAX_ATTEMPTS);
    struct turns_seat seat = {0};
    struct queue_ticket ticket;
    struct queue_job *job;
    double start;
    char what[80];

    for (int64_t id = 1; id <= JOBS; id++)
        add_job(queue, id, id % owners, "0-99");
    start = clock_now_s();
    for (int64_t now_ms = 1; (job = queue_choose_job(queue, &seat)); now_ms++) {
        if (now_ms % 100 == 0) turns_advance(queue_turns(queue), now_ms);
        turns_sit(queue_turns(queue), &seat, &job->turn, false);
        turns_charge(&seat, 1e-3);
        if (queue_take(job, 1, &ticket, 1) != 1 || !queue_succeed(queue, &ticket)) abort();
    }
    snprintf(what, sizeof what, "decisions, one a frame, %d jobs, owners: %d", JOBS, owners);
    print_row(what, clock_now_s() - start, "");
    queue_destroy(queue);
}

// Every frame is taken once and returned, so that all pages are in use.
static void measure_memory(void)
{
    struct queue_ticket *tickets = malloc(FRAME_COUNT * sizeof tickets[0]);
    struct queue *queue = queue_create(MAX_ATTEMPTS);
    double before_mib, mib;

    if (!tickets) abort();
    memset(tickets, 1, FRAME_COUNT * sizeof tickets[0]);
    before_mib = resident_mib();
    add_job(queue, 1, 0, "0-999999");
    if (queue_take(queue_first_job(queue), 1, tickets, FRAME_COUNT) != FRAME_COUNT) abort();
    for (size_t i = 0; i < FRAME_COUNT; i++)
        queue_return(queue, &tickets[i]);
    mib = resident_mib() - before_mib;
    printf("%-54s %9.1f %12s   %s\n", "memory, all taken once and returned, MiB", mib, "", "<= 200 MiB in all");
    queue_destroy(queue);
    free(tickets);
}

int main(void)
{
    printf("%-54s %9s %12s   %s\n", "1,000,000 frames, one core", "seconds", "frames/s", "target");
    measure_memory();
    measure("take, publish, succeed; no-op frames", "0-999999", 0);
    measure("the same, frames of 1 s assigned one by one", "0-999999", 1);
    measure("no-op frames in two interleaved spans", "0-999998x2,1-999999x2", 0);
    measure_retries();
    measure_jobs();
    measure_decisions(1);
    measure_decisions(100);
    return 0;
}
