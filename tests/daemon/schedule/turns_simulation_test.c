// Workers, owners and their jobs on a simulated clock: who waits for how long, and how often workers change.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "daemon/schedule/eta.h"
#include "daemon/schedule/turns.h"
#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

enum { STEP_MS = 10, CHANGE_MS = 250, STAY_MS = 20 * CHANGE_MS, WORKER_LIMIT = 4, JOB_LIMIT = 10100 };

struct sim_job {
    struct turns_job turn;
    int64_t frame_ms, left;
    int64_t submitted_ms, begun_ms; // begun_ms -1: not yet
};

// A worker serves one owner, as a fenced one does, until it is replaced.
struct sim_worker {
    struct turns_seat seat;
    const struct turns_owner *owner; // of its process; NULL: none yet
    int64_t until_ms;                // when its frame is done, or its change
    bool is_busy;
};

struct sim {
    struct turns *turns;
    int64_t now_ms;
    struct sim_worker workers[WORKER_LIMIT];
    int worker_count;
    struct sim_job *jobs; // owned
    size_t job_count;
    int64_t changes;
    int64_t worked_ms[8]; // by uid
};

static struct sim sim_start(int workers)
{
    struct sim sim = {.turns = turns_create(), .worker_count = workers, .jobs = xcalloc(JOB_LIMIT, sizeof *sim.jobs)};

    turns_set_stay_ms(sim.turns, STAY_MS);
    turns_advance(sim.turns, sim.now_ms = 1000 * 1000);
    return sim;
}

static void sim_finish(struct sim *sim)
{
    turns_destroy(sim->turns);
    free(sim->jobs);
}

static struct sim_job *submit(struct sim *sim, int64_t uid, int priority, int64_t frames, int64_t frame_ms)
{
    struct sim_job *job = &sim->jobs[sim->job_count++];

    assert_true(sim->job_count <= JOB_LIMIT);
    *job = (struct sim_job){
        .turn = {.id = (int64_t)sim->job_count, .priority = priority, .owner = turns_find_owner(sim->turns, uid)},
        .frame_ms = frame_ms,
        .left = frames,
        .submitted_ms = sim->now_ms,
        .begun_ms = -1};
    turns_set_ready(sim->turns, &job->turn, true);
    return job;
}

static void begin_frame(struct sim *sim, struct sim_worker *worker, struct sim_job *job)
{
    turns_sit(sim->turns, &worker->seat, &job->turn, false);
    if (--job->left == 0) turns_set_ready(sim->turns, &job->turn, false);
    if (job->begun_ms < 0) job->begun_ms = sim->now_ms;
    worker->is_busy = true;
    worker->until_ms = sim->now_ms + job->frame_ms;
    sim->worked_ms[job->turn.owner->uid] += job->frame_ms;
}

static void feed(struct sim *sim, struct sim_worker *worker)
{
    struct turns_job *next = turns_choose(sim->turns, &worker->seat);

    if (!next) {
        turns_stand(sim->turns, &worker->seat);
    } else if (worker->owner == next->owner) {
        begin_frame(sim, worker, &sim->jobs[next->id - 1]);
    } else {
        turns_sit(sim->turns, &worker->seat, next, true);
        worker->owner = next->owner;
        worker->until_ms = sim->now_ms + CHANGE_MS;
        sim->changes++;
        // Other workers leave the job's only frame to this one.
        if (sim->jobs[next->id - 1].left == 1) turns_cover(sim->turns, next);
    }
}

static void run(struct sim *sim, int64_t ms)
{
    for (int64_t end_ms = sim->now_ms + ms; sim->now_ms < end_ms;) {
        turns_advance(sim->turns, sim->now_ms += STEP_MS);
        for (int i = 0; i < sim->worker_count; i++) {
            struct sim_worker *worker = &sim->workers[i];

            if (worker->is_busy) turns_charge(&worker->seat, STEP_MS / 1000.0);
            if (sim->now_ms < worker->until_ms) continue;
            worker->is_busy = false;
            turns_uncover(sim->turns);
            feed(sim, worker);
        }
    }
}

static void flood(struct sim *sim, int64_t uid, int jobs, int64_t frames, int64_t frame_ms)
{
    for (int i = 0; i < jobs; i++)
        submit(sim, uid, 50, frames, frame_ms);
}

static void flood_lets_a_single_job_begin_at_once(void **state)
{
    enum { FRAME_MS = 3000 };

    for (int workers = 1; workers <= WORKER_LIMIT; workers++) {
        struct sim sim = sim_start(workers);

        flood(&sim, 1, 10000, 3, FRAME_MS);
        run(&sim, 1500);
        for (int i = 0; i < 5; i++) {
            const struct sim_job *single = submit(&sim, 2, 50, 1, FRAME_MS);

            run(&sim, FRAME_MS + CHANGE_MS + 2 * STEP_MS);
            assert_true(single->begun_ms >= 0);
            run(&sim, 17 * 1000 + i * 1234);
        }
        sim_finish(&sim);
    }
}

// Ben has used more lately than Anna: his single job waits for 20 stays of each of them, and the last.
static void single_job_of_a_heavy_user_begins_soon(void **state)
{
    enum { FRAME_MS = 3000 };
    struct sim sim = sim_start(1);
    const struct sim_job *single;

    flood(&sim, 2, 200, 3, FRAME_MS);
    run(&sim, 200 * 3 * FRAME_MS + 1000);
    flood(&sim, 1, 1000, 3, FRAME_MS);
    run(&sim, 1000);
    single = submit(&sim, 2, 50, 1, FRAME_MS);
    run(&sim, 41 * STAY_MS + FRAME_MS + CHANGE_MS + 2 * STEP_MS);
    assert_true(single->begun_ms >= 0);
    sim_finish(&sim);
}

static void shares_follow_the_weights(void **state)
{
    for (int workers = 1; workers <= WORKER_LIMIT; workers++) {
        struct sim sim = sim_start(workers);
        double share;

        turns_find_owner(sim.turns, 2)->weight = 3;
        flood(&sim, 1, 10, 10000, 700);
        flood(&sim, 2, 20, 10000, 100);
        run(&sim, 3600 * 1000);
        share = (double)sim.worked_ms[2] / (double)(sim.worked_ms[1] + sim.worked_ms[2]);
        assert_true(share > 0.73 && share < 0.77);
        sim_finish(&sim);
    }
}

static void changes_take_a_twentieth_at_most(void **state)
{
    for (int workers = 1; workers <= WORKER_LIMIT; workers++) {
        struct sim sim = sim_start(workers);
        int64_t limit = 3600 * 1000 / (STAY_MS + CHANGE_MS) * workers + 6; // each may come without a wait once

        for (int64_t uid = 1; uid <= 6; uid++)
            flood(&sim, uid, 100, 1000, uid * 20);
        run(&sim, 3600 * 1000);
        assert_true(sim.changes <= limit);
        for (int64_t uid = 1; uid <= 6; uid++)
            assert_true(sim.worked_ms[uid] > 3600 * 1000 / 6 * workers * 8 / 10);
        sim_finish(&sim);
    }
}

// A worker that serves two alone changes no more often than it must.
static void two_owners_of_two_workers_do_not_swap_them(void **state)
{
    struct sim sim = sim_start(2);

    flood(&sim, 1, 100, 1000, 170);
    flood(&sim, 2, 100, 1000, 230);
    run(&sim, 3600 * 1000);
    assert_true(sim.changes <= 4);
    sim_finish(&sim);
}

static void nothing_waits_for_ever(void **state)
{
    enum { WAIT_MS = 600 * 1000, FRAME_MS = 2000 };
    struct sim sim = sim_start(1);
    struct sim_job *low;

    turns_set_rules(sim.turns, &(struct turns_rules){.longest_wait_ms = WAIT_MS});
    submit(&sim, 1, 200, 1000 * 1000, FRAME_MS);
    low = submit(&sim, 2, 0, 3, FRAME_MS);
    for (int frame = 2; frame >= 0; frame--) {
        run(&sim, WAIT_MS + 2 * FRAME_MS + CHANGE_MS);
        assert_int_equal(low->left, frame);
    }
    assert_true(sim.worked_ms[1] > 3 * WAIT_MS - 20 * 1000);
    sim_finish(&sim);
}

// Anna may use the workers of one pool, Ben all four: she gets her half, or all of a pool that is smaller.
static void owners_share_workers_whatever_pools_they_may_use(void **state)
{
    for (int pool = 1; pool <= WORKER_LIMIT; pool++) {
        struct sim sim = sim_start(WORKER_LIMIT);
        double share = fmin(0.5, (double)pool / WORKER_LIMIT), found;

        for (int i = 0; i < pool; i++)
            sim.workers[i].seat.kind = 7;
        for (int i = 0; i < 100; i++) {
            struct turns_job *job = &submit(&sim, 1, 50, 10000, 170)->turn;

            turns_set_ready(sim.turns, job, false);
            job->barred = ~(UINT64_C(1) << 7);
            turns_set_ready(sim.turns, job, true);
        }
        flood(&sim, 2, 100, 10000, 230);
        run(&sim, 3600 * 1000);
        found = (double)sim.worked_ms[1] / (double)(sim.worked_ms[1] + sim.worked_ms[2]);
        assert_near(found, share, 0.02);
        assert_true(sim.worked_ms[1] + sim.worked_ms[2] > WORKER_LIMIT * 3600 * 1000 * 9 / 10); // none stands idle
        sim_finish(&sim);
    }
}

enum { ANNA = 1, BEN, CARL };

// Seconds that are told of the job, beside another owner's one and behind one of a higher priority (NULL: none).
static double tell_s(const struct sim *sim, const struct sim_job *job, const struct sim_job *beside,
                     const struct sim_job *front)
{
    double all_s = 1000.0 * sim->worker_count;
    const struct eta_rival rival = {beside->turn.owner, (double)(beside->left * beside->frame_ms) / all_s};

    return eta_find_s(&(struct eta_params){.own_s = (double)(job->left * job->frame_ms) / all_s,
                                           .front_s = front ? (double)(front->left * front->frame_ms) / all_s : 0,
                                           .owner = job->turn.owner,
                                           .rivals = &rival,
                                           .rival_count = 1,
                                           .workers = sim->worker_count,
                                           .half_life_s = 3600});
}

// Runs until both jobs are done, and finds when each was.
static void run_until_done(struct sim *sim, struct sim_job *const jobs[2], double done_s[2])
{
    int64_t begun_ms = sim->now_ms;

    while (jobs[0]->left > 0 || jobs[1]->left > 0) {
        run(sim, 1000);
        for (int i = 0; i < 2; i++)
            if (jobs[i]->left == 0 && done_s[i] == 0) done_s[i] = (double)(sim->now_ms - begun_ms) / 1000;
    }
}

static void what_is_told_of_two_owners_is_how_long_they_take(void **state)
{
    static const struct {
        double weights[2], used_s[2];
        bool has_front;
    } cases[] = {{{1, 1}, {0, 0}, false},    {{1, 3}, {0, 0}, false},   {{4, 1}, {0, 0}, true},
                 {{1, 1}, {2000, 0}, false}, {{1, 1}, {0, 2000}, true}, {{1, 2}, {5000, 1000}, false},
                 {{1, 1}, {20000, 0}, false}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct sim sim = sim_start(2);
        struct sim_job *const jobs[] = {submit(&sim, ANNA, 50, 2000, 900), submit(&sim, BEN, 50, 8000, 700)};
        struct sim_job *front = cases[i].has_front ? submit(&sim, CARL, 60, 1000, 800) : NULL;
        double told_s[2], done_s[2] = {0};

        for (int j = 0; j < 2; j++) {
            jobs[j]->turn.owner->weight = cases[i].weights[j];
            jobs[j]->turn.owner->used_s = cases[i].used_s[j];
        }
        for (int j = 0; j < 2; j++)
            told_s[j] = tell_s(&sim, jobs[j], jobs[!j], front);
        run_until_done(&sim, jobs, done_s);
        for (int j = 0; j < 2; j++)
            assert_near(told_s[j], done_s[j], 0.05 * done_s[j]);
        sim_finish(&sim);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flood_lets_a_single_job_begin_at_once),
        cmocka_unit_test(single_job_of_a_heavy_user_begins_soon),
        cmocka_unit_test(shares_follow_the_weights),
        cmocka_unit_test(changes_take_a_twentieth_at_most),
        cmocka_unit_test(two_owners_of_two_workers_do_not_swap_them),
        cmocka_unit_test(nothing_waits_for_ever),
        cmocka_unit_test(owners_share_workers_whatever_pools_they_may_use),
        cmocka_unit_test(what_is_told_of_two_owners_is_how_long_they_take),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
