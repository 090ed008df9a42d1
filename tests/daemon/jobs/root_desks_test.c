// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/root_desks.h"

#include "daemon/farm/root_table.h"
#include "daemon/loop/work_desk.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { PIECES = 8, LIMIT = 2 };

static struct root hanging, well;
static struct work_piece stuck[PIECES], other;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t changed = PTHREAD_COND_INITIALIZER;
static int running, most, done;
static bool is_free;

static void free_all(void)
{
    is_free = true;
    pthread_cond_broadcast(&changed);
}

// Hangs until the other root's piece has run, or until more of them run than may.
static void hang(struct work_piece *piece)
{
    (void)piece;
    pthread_mutex_lock(&lock);
    if (++running > most) most = running;
    if (running > LIMIT) free_all();
    while (!is_free)
        pthread_cond_wait(&changed, &lock);
    running--;
    pthread_mutex_unlock(&lock);
}

static void run_other(struct work_piece *piece)
{
    (void)piece;
    pthread_mutex_lock(&lock);
    free_all();
    pthread_mutex_unlock(&lock);
}

static void note_done(struct work_piece *piece, bool was_run)
{
    (void)piece;
    done += was_run;
}

static void a_root_that_hangs_leaves_threads_to_others(void **state)
{
    uv_loop_t loop;
    struct root_desks *desks;

    (void)state;
    uv_loop_init(&loop);
    desks = root_desks_create(&loop);
    for (int i = 0; i < PIECES; i++) {
        stuck[i] = (struct work_piece){.run = hang, .done = note_done, .uid = 1000 + i};
        root_desks_put(desks, &hanging, &stuck[i]);
    }
    other = (struct work_piece){.run = run_other, .done = note_done, .uid = 1000};
    root_desks_put(desks, &well, &other);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(done, PIECES + 1);
    assert_true(most <= LIMIT);
    root_desks_destroy(desks);
    assert_int_equal(uv_loop_close(&loop), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_root_that_hangs_leaves_threads_to_others)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
