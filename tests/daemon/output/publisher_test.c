// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/publisher.h"

#include "daemon/farm/job_table.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <uv.h>

#include <cmocka.h>

struct counts {
    uv_check_t turn;
    int done, this_turn, most;
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
    assert_int_equal(request->ticket.index, counts->done++);
    if (++counts->this_turn > counts->most) counts->most = counts->this_turn;
}

// However many frames workers find at once: each turn of the loop tells of some, in order, and no more are to be begun
// while too many wait.
static void what_waits_is_told_in_batches(void **state)
{
    struct counts counts = {0};
    struct root root = {.id = "0123456789abcdef0123456789abcdef"};
    char path[] = "/nowhere";
    struct job_record record = {.id = 1, .root = path, .output_root = &root};
    struct publish_request request = {.record = &record, .ticket = {.job = 1}};
    struct publisher *publisher;
    uv_loop_t loop;

    uv_loop_init(&loop);
    uv_check_init(&loop, &counts.turn);
    counts.turn.data = &counts;
    uv_check_start(&counts.turn, on_turn);
    uv_unref((uv_handle_t *)&counts.turn);
    publisher = publisher_create(&loop, "farm", NULL, on_done, &counts);
    while (!publisher_is_full(publisher)) {
        publisher_put_found(publisher, &request);
        request.ticket.index++;
    }
    assert_in_range(request.ticket.index, PUBLISHER_FULL, PUBLISHER_FULL + PUBLISHER_BATCH);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(counts.done, request.ticket.index);
    assert_in_range(counts.most, 1, PUBLISHER_BATCH);
    assert_false(publisher_is_full(publisher));
    assert_true(publisher_is_idle(publisher));
    publisher_destroy(publisher);
    uv_close((uv_handle_t *)&counts.turn, NULL);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_waits_is_told_in_batches)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
