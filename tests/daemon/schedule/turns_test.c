// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/turns.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { ANNA = 1000, BEN = 1001, CARL = 1002, STAY_MS = 5000, HOUR_MS = 3600 * 1000 };

struct fixture {
    struct turns *turns;
    int64_t now_ms;
    struct turns_job jobs[8];
    size_t count;
};

static int setup(void **state)
{
    static struct fixture fixture;

    fixture = (struct fixture){.turns = turns_create()};
    *state = &fixture;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *fixture = *state;

    turns_destroy(fixture->turns);
    return 0;
}

static void pass(struct fixture *fixture, int64_t ms)
{
    turns_advance(fixture->turns, fixture->now_ms += ms);
}

static struct turns_owner *owner(struct fixture *fixture, int64_t uid)
{
    return turns_find_owner(fixture->turns, uid);
}

// Ids count from 1.
static struct turns_job *add(struct fixture *fixture, int64_t uid, int priority)
{
    struct turns_job *job = &fixture->jobs[fixture->count++];

    *job = (struct turns_job){.id = (int64_t)fixture->count, .priority = priority, .owner = owner(fixture, uid)};
    turns_set_ready(fixture->turns, job, true);
    return job;
}

static int64_t choose(struct fixture *fixture, const struct turns_seat *seat)
{
    const struct turns_job *job = turns_choose(fixture->turns, seat ? seat : &(struct turns_seat){0});

    return job ? job->id : 0;
}

// A job that only seats of the kind may serve.
static struct turns_job *add_for(struct fixture *fixture, int64_t uid, int kind)
{
    struct turns_job *job = add(fixture, uid, 50);

    turns_set_ready(fixture->turns, job, false);
    job->barred = ~(UINT64_C(1) << kind);
    turns_set_ready(fixture->turns, job, true);
    return job;
}

// The seat's worker serves the owner for so long.
static void work(struct fixture *fixture, struct turns_seat *seat, struct turns_job *job, int64_t ms)
{
    turns_sit(fixture->turns, seat, job, false);
    pass(fixture, ms);
    turns_charge(seat, (double)ms / 1000);
}

static void ready_jobs_are_walked_lane_by_lane(void **state)
{
    struct fixture *fixture = *state;
    // Jobs 1 to 6; the fourth is not ready, and one lane is barred from a kind.
    const struct turns_job *added[] = {add(fixture, ANNA, 50), add(fixture, BEN, 70), add(fixture, ANNA, 50),
                                       add(fixture, ANNA, 50), add(fixture, ANNA, 0), add_for(fixture, ANNA, 1)};
    const struct turns_job *job = NULL, *last = NULL;
    int seen = 0;

    turns_set_ready(fixture->turns, &fixture->jobs[3], false);
    while ((job = turns_next_ready(fixture->turns, job))) {
        if (last) assert_true(last->priority >= job->priority);
        if (job == added[2]) assert_ptr_equal(last, added[0]); // of a lane by id, and nothing between
        seen |= 1 << job->id;
        last = job;
    }
    assert_int_equal(seen, 1 << 1 | 1 << 2 | 1 << 3 | 1 << 5 | 1 << 6);
    assert_ptr_equal(last, added[4]);
    for (size_t i = 0; i < fixture->count; i++)
        turns_set_ready(fixture->turns, &fixture->jobs[i], false);
    assert_null(turns_next_ready(fixture->turns, NULL));
}

static void of_one_owner_priority_then_id_decides(void **state)
{
    struct fixture *fixture = *state;
    const int64_t expected[] = {3, 5, 1, 2, 4, 0};

    for (int i = 0; i < 5; i++)
        add(fixture, ANNA, (int[]){50, 50, 200, 0, 200}[i]);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(choose(fixture, NULL), expected[i]);
        if (expected[i]) turns_set_ready(fixture->turns, &fixture->jobs[expected[i] - 1], false);
    }
    // A job that comes back takes its place.
    turns_set_ready(fixture->turns, &fixture->jobs[1], true);
    turns_set_ready(fixture->turns, &fixture->jobs[0], true);
    assert_int_equal(choose(fixture, NULL), 1);
}

static void who_used_less_for_their_weight_is_first(void **state)
{
    struct fixture *fixture = *state;

    add(fixture, ANNA, 50);
    add(fixture, BEN, 50);
    assert_int_equal(choose(fixture, NULL), 1); // nobody used anything: the first job
    owner(fixture, ANNA)->used_s = 10;
    owner(fixture, BEN)->used_s = 6;
    assert_int_equal(choose(fixture, NULL), 2);
    owner(fixture, ANNA)->weight = 2;
    assert_int_equal(choose(fixture, NULL), 1);
    add(fixture, BEN, 51);
    assert_int_equal(choose(fixture, NULL), 3);
}

static void half_of_the_use_is_forgotten_in_a_half_life(void **state)
{
    struct fixture *fixture = *state;

    owner(fixture, ANNA)->used_s = 8;
    pass(fixture, HOUR_MS);
    assert_true(owner(fixture, ANNA)->used_s > 3.99 && owner(fixture, ANNA)->used_s < 4.01);
    turns_set_rules(fixture->turns, &(struct turns_rules){.half_life_s = 1800});
    pass(fixture, HOUR_MS);
    assert_true(owner(fixture, ANNA)->used_s > 0.99 && owner(fixture, ANNA)->used_s < 1.01);
}

static void seat_stays_with_its_owner_for_the_stay(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat seat = {0}, other = {0};
    struct turns_job *annas = add(fixture, ANNA, 50), *bens = add(fixture, BEN, 50);

    pass(fixture, 1);
    work(fixture, &other, bens, 1); // Ben has a worker
    work(fixture, &seat, annas, STAY_MS - 1);
    owner(fixture, ANNA)->used_s = 100;
    assert_int_equal(choose(fixture, &seat), 1);
    assert_false(turns_outranks(fixture->turns, &seat, bens, annas));
    pass(fixture, 1);
    assert_int_equal(choose(fixture, &seat), 2);
    assert_true(turns_outranks(fixture->turns, &seat, bens, annas));
    // A higher priority does not wait.
    turns_sit(fixture->turns, &seat, bens, false);
    assert_int_equal(choose(fixture, &seat), 2);
    add(fixture, ANNA, 51);
    assert_int_equal(choose(fixture, &seat), 3);
    assert_true(turns_outranks(fixture->turns, &seat, &fixture->jobs[2], bens));
}

static void who_has_no_worker_does_not_wait_for_the_stay(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat seat = {0};
    struct turns_job *annas = add(fixture, ANNA, 50), *bens;

    pass(fixture, 1);
    work(fixture, &seat, annas, 10);
    bens = add(fixture, BEN, 50);
    assert_int_equal(choose(fixture, &seat), 2);
    // The one who interrupted is not interrupted: 20 such users would keep workers changing.
    turns_sit(fixture->turns, &seat, bens, false);
    add(fixture, CARL, 50);
    assert_int_equal(choose(fixture, &seat), 2);
    work(fixture, &seat, bens, STAY_MS);
    assert_int_equal(choose(fixture, &seat), 3);
    // Ben has left just now: he is no newcomer when he is back.
    work(fixture, &seat, &fixture->jobs[2], STAY_MS - 1);
    turns_set_ready(fixture->turns, annas, false);
    owner(fixture, CARL)->used_s = 100;
    assert_int_equal(choose(fixture, &seat), 3);
}

// As after a restart, when all owners are new.
static void who_used_more_does_not_take_a_worker_for_being_new(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat seat = {0};
    struct turns_job *bens;

    pass(fixture, HOUR_MS);
    add(fixture, ANNA, 50);
    bens = add(fixture, BEN, 50);
    owner(fixture, ANNA)->used_s = 1000;
    assert_int_equal(choose(fixture, &seat), 2);
    turns_sit(fixture->turns, &seat, bens, false);
    assert_int_equal(choose(fixture, &seat), 2);
    assert_false(turns_outranks(fixture->turns, &seat, &fixture->jobs[0], bens));
}

static void who_has_no_worker_for_20_stays_of_each_is_served_whatever_they_used(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat seat = {0};
    struct turns_job *annas = add(fixture, ANNA, 50), *bens = add(fixture, BEN, 50);

    pass(fixture, 1);
    work(fixture, &seat, bens, 1);
    owner(fixture, BEN)->used_s = 1e6;
    work(fixture, &seat, annas, 40 * STAY_MS - 1);
    assert_int_equal(choose(fixture, &seat), 1);
    pass(fixture, 1);
    assert_int_equal(choose(fixture, &seat), 2);
}

static void owners_share_workers_rather_than_swap_them(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat seats[2] = {0};
    struct turns_job *jobs[2] = {add(fixture, ANNA, 50), add(fixture, BEN, 50)};

    pass(fixture, 1);
    for (int i = 0; i < 2; i++)
        turns_sit(fixture->turns, &seats[i], jobs[choose(fixture, &seats[i]) - 1], false);
    assert_int_equal(owner(fixture, ANNA)->workers, 1);
    for (int round = 0; round < 20; round++) {
        pass(fixture, STAY_MS);
        for (int i = 0; i < 2; i++) {
            turns_charge(&seats[i], (round + i) % 2 ? 4.9 : 5.1);
            assert_int_equal(choose(fixture, &seats[i]), i + 1);
        }
    }
}

static void what_waited_longest_comes_once_whatever_its_priority(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat seat = {0}, other = {0};
    struct turns_job *annas = add(fixture, ANNA, 100), *bens = add(fixture, BEN, 0);

    turns_set_rules(fixture->turns, &(struct turns_rules){.longest_wait_ms = HOUR_MS});
    for (int minute = 1; minute < 60; minute++) {
        pass(fixture, HOUR_MS / 60);
        assert_int_equal(choose(fixture, &seat), 1);
        turns_sit(fixture->turns, &seat, annas, false);
    }
    pass(fixture, HOUR_MS / 60);
    assert_int_equal(choose(fixture, &seat), 2);
    // While the worker changes, others do not, and its choice stays.
    turns_sit(fixture->turns, &seat, bens, true);
    turns_sit(fixture->turns, &seat, bens, true);
    assert_int_equal(choose(fixture, &other), 1);
    assert_int_equal(choose(fixture, &seat), 2);
    turns_sit(fixture->turns, &seat, bens, false);
    assert_int_equal(choose(fixture, &seat), 1);
}

static void covered_jobs_leave_the_turn_to_the_next(void **state)
{
    struct fixture *fixture = *state;
    struct turns_job *first = add(fixture, ANNA, 50);

    add(fixture, ANNA, 50);
    add(fixture, BEN, 20);
    turns_cover(fixture->turns, first);
    assert_int_equal(choose(fixture, NULL), 2);
    turns_cover(fixture->turns, &fixture->jobs[1]);
    assert_int_equal(choose(fixture, NULL), 3);
    turns_set_ready(fixture->turns, first, false);
    turns_uncover(fixture->turns);
    assert_int_equal(choose(fixture, NULL), 2);
    turns_set_ready(fixture->turns, first, true);
    assert_int_equal(choose(fixture, NULL), 1);
}

static void worker_that_changes_for_a_job_gets_it_unless_a_higher_priority_comes(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat seat = {0};
    struct turns_job *bens;

    add(fixture, ANNA, 50);
    bens = add(fixture, BEN, 50);
    turns_sit(fixture->turns, &seat, bens, true);
    owner(fixture, BEN)->used_s = 1e6;
    pass(fixture, 2 * STAY_MS);
    assert_int_equal(choose(fixture, &seat), 2);
    add(fixture, ANNA, 51);
    assert_int_equal(choose(fixture, &seat), 3);
    turns_stand(fixture->turns, &seat);
    assert_int_equal(owner(fixture, BEN)->workers, 0);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

static void a_seat_serves_no_job_that_is_barred_from_its_kind(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat near = {0}, far = {.kind = 63};

    add_for(fixture, ANNA, 63);
    add_for(fixture, ANNA, 0);
    add(fixture, ANNA, 50);
    assert_int_equal(choose(fixture, &near), 2);
    assert_int_equal(choose(fixture, &far), 1);
    // Of several jobs that it may serve, the owner's first.
    work(fixture, &far, &fixture->jobs[0], 10);
    turns_set_ready(fixture->turns, &fixture->jobs[1], false);
    assert_int_equal(choose(fixture, &near), 3);
    assert_int_equal(choose(fixture, &far), 1);
    turns_set_ready(fixture->turns, &fixture->jobs[0], false);
    assert_int_equal(choose(fixture, &far), 3);
    // The kind is that of its worker, whomever it serves.
    turns_sit(fixture->turns, &far, &fixture->jobs[2], false);
    turns_stand(fixture->turns, &far);
    turns_set_ready(fixture->turns, &fixture->jobs[0], true);
    turns_set_ready(fixture->turns, &fixture->jobs[2], false);
    assert_int_equal(choose(fixture, &far), 1);
    assert_int_equal(choose(fixture, &near), 0);
}

static void who_waits_for_another_kind_comes_before_nobody(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat near = {0};

    turns_set_rules(fixture->turns, &(struct turns_rules){.longest_wait_ms = HOUR_MS});
    add_for(fixture, ANNA, 1);
    add(fixture, BEN, 0);
    pass(fixture, 2 * HOUR_MS); // Anna starves, and her job waited for too long
    assert_int_equal(choose(fixture, &near), 2);
    assert_int_equal(choose(fixture, &(struct turns_seat){.kind = 1}), 1);
}

// Anna used a pool for herself; of the seats that both may have, Ben gets the next.
static void use_counts_wherever_it_was(void **state)
{
    struct fixture *fixture = *state;
    struct turns_seat near = {0}, far = {.kind = 1};

    work(fixture, &far, add_for(fixture, ANNA, 1), 60 * 1000);
    add(fixture, ANNA, 50);
    add(fixture, BEN, 50);
    assert_int_equal(choose(fixture, &near), 3);
    assert_int_equal(choose(fixture, &far), 3);
    owner(fixture, BEN)->used_s = 100;
    assert_int_equal(choose(fixture, &near), 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(ready_jobs_are_walked_lane_by_lane),
        TEST(of_one_owner_priority_then_id_decides),
        TEST(who_used_less_for_their_weight_is_first),
        TEST(half_of_the_use_is_forgotten_in_a_half_life),
        TEST(seat_stays_with_its_owner_for_the_stay),
        TEST(who_has_no_worker_does_not_wait_for_the_stay),
        TEST(who_used_more_does_not_take_a_worker_for_being_new),
        TEST(who_has_no_worker_for_20_stays_of_each_is_served_whatever_they_used),
        TEST(owners_share_workers_rather_than_swap_them),
        TEST(what_waited_longest_comes_once_whatever_its_priority),
        TEST(covered_jobs_leave_the_turn_to_the_next),
        TEST(worker_that_changes_for_a_job_gets_it_unless_a_higher_priority_comes),
        TEST(a_seat_serves_no_job_that_is_barred_from_its_kind),
        TEST(who_waits_for_another_kind_comes_before_nobody),
        TEST(use_counts_wherever_it_was),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
