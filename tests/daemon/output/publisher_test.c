// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/publisher.h"

#include "daemon/farm/job_table.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <uv.h>

#include <cmocka.h>

enum { PATIENCE_S = 100 }; // a guard against what never happens

static uv_sem_t hanging, thawed; // the root /hanging has been asked for; it answers again
static bool has_given_up;

// Stands for a disk or a server that does not answer until another root's frame is published.
int open(const char *path, int flags, ...)
{
    va_list rest;
    mode_t mode;

    va_start(rest, flags);
    mode = flags & O_CREAT ? (mode_t)va_arg(rest, int) : 0;
    va_end(rest);
    if (strcmp(path, "/hanging") == 0) {
        uv_sem_post(&hanging);
        uv_sem_wait(&thawed);
    }
    return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

enum { LIMIT = PUBLISHER_FULL + PUBLISHER_BATCH * PUBLISHER_HANDS };

struct counts {
    uv_check_t turn;
    int done, this_turn, most;
    bool is_done[LIMIT];
};

static void on_turn(uv_check_t *turn)
{
    ((struct counts *)turn->data)->this_turn = 0;
}

static void on_done(void *user, const struct publish_request *request)
{
    struct counts *counts = user;

    assert_int_equal(request->outcome, PUBLISH_OUTCOME_NO_ROOT);
    assert_non_null(strstr(request->error, "/nowhere"));
    assert_false(counts->is_done[request->ticket.index]);
    counts->is_done[request->ticket.index] = true;
    counts->done++;
    if (++counts->this_turn > counts->most) counts->most = counts->this_turn;
}

// However many frames workers find at once: each turn of the loop tells of some, and no more are to be begun while too
// many wait.
static void what_waits_is_done_in_batches(void **state)
{
    static struct counts counts;
    struct root root = {.id = "0123456789abcdef0123456789abcdef"};
    char path[] = "/nowhere";
    struct job_record record = {.id = 1, .root = path, .output_root = &root};
    struct publish_request request = {.record = &record, .ticket = {.job = 1}};
    struct publisher *publisher;
    uv_loop_t loop;
    bool is_in_step = true;

    uv_loop_init(&loop);
    uv_check_init(&loop, &counts.turn);
    counts.turn.data = &counts;
    uv_check_start(&counts.turn, on_turn);
    uv_unref((uv_handle_t *)&counts.turn);
    publisher = publisher_create(&loop, "farm", NULL, on_done, &counts);
    while (!publisher_is_full(publisher)) {
        // The first waits for nobody, and neither does a full batch behind it, until all hands work.
        uint64_t hands = request.ticket.index ? 1 + (uint64_t)(request.ticket.index - 1) / PUBLISHER_BATCH : 0;

        is_in_step = is_in_step && loop.active_reqs.count == (hands < PUBLISHER_HANDS ? hands : PUBLISHER_HANDS);
        publisher_put_found(publisher, &request);
        request.ticket.index++;
    }
    assert_in_range(request.ticket.index, PUBLISHER_FULL, LIMIT);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_true(is_in_step);
    assert_int_equal(counts.done, request.ticket.index);
    assert_in_range(counts.most, 1, PUBLISHER_BATCH * PUBLISHER_HANDS);
    assert_false(publisher_is_full(publisher));
    assert_true(publisher_is_idle(publisher));
    publisher_destroy(publisher);
    uv_close((uv_handle_t *)&counts.turn, NULL);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
}

static void on_patience_end(uv_timer_t *timer)
{
    (void)timer;
    has_given_up = true;
    uv_sem_post(&thawed);
}

// The frame of the root that hangs comes last.
static void note_order(void *user, const struct publish_request *request)
{
    uv_timer_t *guard = user;
    static int count;

    assert_int_equal(count++, request->ticket.job == 2 ? 0 : 1);
    if (request->ticket.job == 2) uv_sem_post(&thawed);
    uv_timer_stop(guard);
}

static void a_root_that_hangs_holds_up_no_other(void **state)
{
    struct root roots[2] = {{.id = "0123456789abcdef0123456789abcdef"}, {.id = "0123456789abcdef0123456789abcdef"}};
    char first[] = "/hanging", second[] = "/nowhere";
    struct job_record records[2] = {{.id = 1, .root = first, .output_root = &roots[0]},
                                    {.id = 2, .root = second, .output_root = &roots[1]}};
    struct publisher *publisher;
    uv_loop_t loop;
    uv_timer_t guard;

    assert_int_equal(uv_sem_init(&hanging, 0) | uv_sem_init(&thawed, 0), 0);
    uv_loop_init(&loop);
    uv_timer_init(&loop, &guard);
    uv_timer_start(&guard, on_patience_end, PATIENCE_S * 1000, 0);
    publisher = publisher_create(&loop, "farm", NULL, note_order, &guard);
    publisher_put_found(publisher, &(struct publish_request){.record = &records[0], .ticket = {.job = 1}});
    uv_sem_wait(&hanging);
    publisher_put_found(publisher, &(struct publish_request){.record = &records[1], .ticket = {.job = 2}});
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_false(has_given_up);
    assert_true(publisher_is_idle(publisher));
    publisher_destroy(publisher);
    uv_close((uv_handle_t *)&guard, NULL);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    uv_sem_destroy(&hanging);
    uv_sem_destroy(&thawed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_waits_is_done_in_batches),
                                       cmocka_unit_test(a_root_that_hangs_holds_up_no_other)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
