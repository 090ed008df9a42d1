// Waiting for a plan, by a clock that nobody sets.
// SPDX-License-Identifier: Apache-2.0
#include "worker/process/plan_post.h"

#include "worker/process/worker.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { TICKS = 3 };

static struct held_job job;
static int ticks;

// Stands in for the time that passes: the answer comes with the last tick.
int pthread_cond_clockwait(pthread_cond_t *condition, pthread_mutex_t *lock, clockid_t clock,
                           const struct timespec *until)
{
    (void)condition;
    (void)lock;
    (void)until;
    assert_int_equal(clock, CLOCK_MONOTONIC);
    if (++ticks == TICKS) plan_mail_find(&job.plans, "segment")->said = PLAN_SAID_MAKE;
    return ETIMEDOUT;
}

// By this one a wait that begins before the clock is set back lasts until the clock is there again.
int pthread_cond_timedwait(pthread_cond_t *condition, pthread_mutex_t *lock, const struct timespec *until)
{
    (void)condition;
    (void)lock;
    (void)until;
    fail_msg("a wait by the clock that people set");
    return 0;
}

static void waiting_is_progress_whatever_the_clock_does(void **state)
{
    struct assignment_frame frame = {.job = &job};
    struct worker worker = {0};
    struct plan_post post = {.worker = &worker, .frame = &frame};
    struct plan_source source = plan_post_open(&post);
    struct plan_json plan;
    int64_t number = 0;
    int sockets[2];

    (void)state;
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, sockets), 0);
    connection_init(&worker.connection, sockets[0]);
    pthread_mutex_init(&worker.lock, NULL);
    pthread_cond_init(&worker.changed, NULL);
    assert_int_equal(source.find(source.user, "segment", &number, &plan, NULL), PLAN_SOURCE_MAKE);
    assert_int_equal(ticks, TICKS);
    assert_int_equal(worker.progress, TICKS);
    connection_finish(&worker.connection);
    close(sockets[1]);
    plan_mail_finish(&job.plans);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(waiting_is_progress_whatever_the_clock_does)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
