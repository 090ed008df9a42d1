// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_lanes.h"

#include "core/base/alloc.h"

#include <errno.h>
#include <semaphore.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

enum { LATE_MS = 600000 };

struct step {
    struct lane_task task;
    sem_t *begun, *go; // posted when it runs, waited for before it ends; NULL: neither
    int number;
    atomic_int *released;
};

struct stage {
    struct picture_lanes *lanes;
    sem_t begun, go, told;
    int numbers[64]; // of those that were told, in order; guarded by `told`
    atomic_int told_count, released;
};

static void wait_for(sem_t *semaphore)
{
    while (sem_wait(semaphore) != 0)
        assert_int_equal(errno, EINTR);
}

static void run(struct lane_task *task)
{
    struct step *step = (struct step *)task;

    if (!step->go) return;
    sem_post(step->begun);
    wait_for(step->go);
}

static void on_done(struct lane_task *task, void *user)
{
    struct step *step = (struct step *)task;
    struct stage *stage = user;

    stage->numbers[atomic_fetch_add(&stage->told_count, 1)] = step->number;
    free(step);
    sem_post(&stage->told);
}

static void release(struct lane_task *task)
{
    struct step *step = (struct step *)task;

    atomic_fetch_add(step->released, 1);
    free(step);
}

static void begin(struct stage *stage, int late_ms)
{
    *stage = (struct stage){.lanes = picture_lanes_create(&(struct picture_lanes_params){
                                .run = run, .done = on_done, .release = release, .user = stage, .late_ms = late_ms})};
    sem_init(&stage->begun, 0, 0);
    sem_init(&stage->go, 0, 0);
    sem_init(&stage->told, 0, 0);
}

static enum lane_entry add(struct stage *stage, const char *lane, int number, bool hangs)
{
    struct step *step = xcalloc(1, sizeof *step);
    enum lane_entry entry;

    *step = (struct step){.number = number, .released = &stage->released};
    if (hangs) {
        step->begun = &stage->begun;
        step->go = &stage->go;
    }
    entry = picture_lanes_add(stage->lanes, lane, &step->task);
    if (entry != LANE_ENTERED) free(step);
    return entry;
}

static void lane_that_hangs_holds_up_no_other(void **state)
{
    struct stage stage;

    begin(&stage, LATE_MS);
    assert_int_equal(add(&stage, "/a", 1, true), LANE_ENTERED);
    wait_for(&stage.begun);
    assert_int_equal(add(&stage, "/a", 2, false), LANE_ENTERED);
    for (int number = 3; number < 6; number++) {
        assert_int_equal(add(&stage, "/b", number, false), LANE_ENTERED);
        wait_for(&stage.told);
        assert_int_equal(stage.numbers[number - 3], number);
    }
    sem_post(&stage.go);
    wait_for(&stage.told);
    wait_for(&stage.told);
    assert_int_equal(stage.numbers[3], 1);
    assert_int_equal(stage.numbers[4], 2); // and after it, in its lane
    picture_lanes_stop(stage.lanes);
    assert_int_equal(stage.released, 0);
}

// As many as there are threads hang; what comes then goes on when one of them does.
static void lanes_beyond_the_threads_wait_for_one(void **state)
{
    struct stage stage;

    begin(&stage, LATE_MS);
    for (int i = 0; i < LANE_THREAD_LIMIT; i++) {
        char lane[16];

        snprintf(lane, sizeof lane, "/%d", i);
        assert_int_equal(add(&stage, lane, i, true), LANE_ENTERED);
        wait_for(&stage.begun);
    }
    assert_int_equal(add(&stage, "/other", 99, true), LANE_ENTERED);
    assert_int_equal(sem_trywait(&stage.begun), -1);
    sem_post(&stage.go);
    wait_for(&stage.begun);
    for (int i = 0; i < LANE_THREAD_LIMIT; i++)
        sem_post(&stage.go);
    for (int i = 0; i <= LANE_THREAD_LIMIT; i++)
        wait_for(&stage.told);
    picture_lanes_stop(stage.lanes);
}

static void lane_that_is_late_or_full_refuses(void **state)
{
    struct stage stage;

    begin(&stage, 0);
    assert_int_equal(add(&stage, "/a", 1, true), LANE_ENTERED);
    wait_for(&stage.begun);
    usleep(2000); // longer than 0 ms
    assert_int_equal(add(&stage, "/a", 2, false), LANE_LATE);
    assert_int_equal(add(&stage, "/b", 3, false), LANE_ENTERED);
    wait_for(&stage.told);
    sem_post(&stage.go);
    wait_for(&stage.told);
    assert_int_equal(add(&stage, "/a", 4, false), LANE_ENTERED); // it gets on again
    wait_for(&stage.told);
    picture_lanes_stop(stage.lanes);
    begin(&stage, LATE_MS);
    assert_int_equal(add(&stage, "/a", 1, true), LANE_ENTERED);
    wait_for(&stage.begun);
    for (int i = 0; i < LANE_WAIT_LIMIT; i++)
        assert_int_equal(add(&stage, "/a", 2, true), LANE_ENTERED);
    assert_int_equal(add(&stage, "/a", 3, false), LANE_FULL);
    assert_int_equal(add(&stage, "/b", 4, false), LANE_ENTERED);
    wait_for(&stage.told);
    picture_lanes_stop(stage.lanes);
    assert_int_equal(stage.released, LANE_WAIT_LIMIT);
    sem_post(&stage.go);
    while (stage.released <= LANE_WAIT_LIMIT)
        usleep(1000);
}

// The end does not wait for what hangs: that is released when it hangs no more, and told to nobody.
static void end_waits_for_no_disk(void **state)
{
    struct stage stage;

    begin(&stage, LATE_MS);
    assert_int_equal(add(&stage, "/a", 1, true), LANE_ENTERED);
    assert_int_equal(add(&stage, "/a", 2, false), LANE_ENTERED);
    wait_for(&stage.begun);
    picture_lanes_stop(stage.lanes);
    assert_int_equal(stage.released, 1); // what had not begun
    sem_post(&stage.go);
    while (stage.released < 2)
        usleep(1000);
    assert_int_equal(stage.told_count, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lane_that_hangs_holds_up_no_other),
        cmocka_unit_test(lanes_beyond_the_threads_wait_for_one),
        cmocka_unit_test(lane_that_is_late_or_full_refuses),
        cmocka_unit_test(end_waits_for_no_disk),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
