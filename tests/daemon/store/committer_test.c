// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/committer.h"
#include "tests/daemon/store/store_fixture.h"

// The results of the callbacks, in order: "3+" when ops tagged 3 are on disk, "3-" for a failure.
static char told[256];

static void on_done(void *user, bool ok, const struct error *error)
{
    size_t length = strlen(told);

    snprintf(told + length, sizeof told - length, "%s%d%c", length ? " " : "", *(const int *)user, ok ? '+' : '-');
    assert_true(ok || error->message[0]);
}

static void put(struct committer *committer, enum commit_policy policy, int64_t job, const int *tag)
{
    struct store_op op = job_op(job);

    committer_put(committer, policy, &op, 1, on_done, (void *)tag);
}

static bool count_job(void *user, const struct store_job *job, struct error *error)
{
    (*(size_t *)user)++;
    return true;
}

static bool count_frame(void *user, const struct store_frame *frame, struct error *error)
{
    return true;
}

static size_t count_jobs(struct store *store)
{
    size_t count = 0;

    assert_true(store_load(store, count_job, count_frame, &count, NULL));
    return count;
}

static void finish(uv_loop_t *loop, struct committer *committer, struct store *store)
{
    assert_true(committer_is_idle(committer));
    committer_close(committer);
    uv_run(loop, UV_RUN_DEFAULT);
    committer_destroy(committer);
    assert_int_equal(uv_loop_close(loop), 0);
    store_close(store);
}

static void callbacks_come_in_order_after_the_commit(void **state)
{
    static const int one = 1, two = 2, three = 3;
    struct store *store = open_store(*state);
    struct committer *committer;
    uv_loop_t loop;

    told[0] = '\0';
    uv_loop_init(&loop);
    committer = committer_create(&loop, store);
    put(committer, COMMIT_CERTAIN, 1, &one);
    put(committer, COMMIT_REPORTED, 2, &two);
    put(committer, COMMIT_OR_DROP, 3, &three);
    assert_int_equal(committer_waiting(committer), 3);
    assert_string_equal(told, "");
    while (!committer_is_idle(committer))
        uv_run(&loop, UV_RUN_ONCE);
    assert_string_equal(told, "1+ 2+ 3+");
    assert_int_equal(count_jobs(store), 3);
    finish(&loop, committer, store);
}

// A job id that is in use makes the whole batch fail, as a full disk does.
static void a_failed_batch_is_reported_dropped_or_kept_by_policy(void **state)
{
    static const int ten = 10, certain = 1, reported = 2, dropped = 3, taken = 4;
    struct store *store = open_store(*state);
    struct committer *committer;
    uv_loop_t loop;

    told[0] = '\0';
    uv_loop_init(&loop);
    committer = committer_create(&loop, store);
    put(committer, COMMIT_CERTAIN, 10, &ten);
    put(committer, COMMIT_CERTAIN, 1, &certain);
    put(committer, COMMIT_REPORTED, 2, &reported);
    put(committer, COMMIT_OR_DROP, 3, &dropped);
    put(committer, COMMIT_OR_DROP, 10, &taken);
    while (!committer_trouble(committer))
        uv_run(&loop, UV_RUN_ONCE);
    assert_string_equal(told, "10+ 2- 3- 4-");
    assert_int_equal(count_jobs(store), 1);
    assert_int_equal(committer_waiting(committer), 2);
    while (!committer_is_idle(committer))
        uv_run(&loop, UV_RUN_ONCE);
    assert_string_equal(told, "10+ 2- 3- 4- 1+");
    assert_null(committer_trouble(committer));
    assert_int_equal(count_jobs(store), 3);
    finish(&loop, committer, store);
}

// While failed ops wait for the next try, a new op is answered at once.
static void a_lasting_failure_is_reported_to_later_ops(void **state)
{
    static const int kept = 1, dropped = 2, reported = 3;
    struct store *store = open_store(*state);
    struct committer *committer;
    uv_loop_t loop;

    told[0] = '\0';
    uv_loop_init(&loop);
    committer = committer_create(&loop, store);
    put(committer, COMMIT_CERTAIN, 1, &kept);
    while (!committer_is_idle(committer))
        uv_run(&loop, UV_RUN_ONCE);
    // The id stays in use.
    put(committer, COMMIT_CERTAIN, 1, &kept);
    while (!committer_trouble(committer))
        uv_run(&loop, UV_RUN_ONCE);
    put(committer, COMMIT_OR_DROP, 2, &dropped);
    put(committer, COMMIT_REPORTED, 3, &reported);
    while (!strchr(told, '3'))
        uv_run(&loop, UV_RUN_ONCE);
    assert_string_equal(told, "1+ 2- 3-");
    assert_int_equal(committer_waiting(committer), 2);
    assert_int_equal(count_jobs(store), 1);
    // The ops that wait can never be committed, so the committer is destroyed with them.
    committer_close(committer);
    uv_run(&loop, UV_RUN_DEFAULT);
    committer_destroy(committer);
    assert_int_equal(uv_loop_close(&loop), 0);
    store_close(store);
}

// The callback of a flush comes after the ops before it.
static void a_flush_waits_for_the_ops_before_it(void **state)
{
    static const int idle = 1, put_one = 2, behind = 3, later = 4;
    struct store *store = open_store(*state);
    struct committer *committer;
    uv_loop_t loop;

    told[0] = '\0';
    uv_loop_init(&loop);
    committer = committer_create(&loop, store);
    committer_flush(committer, on_done, (void *)&idle);
    assert_string_equal(told, "1+");
    put(committer, COMMIT_CERTAIN, 1, &put_one);
    committer_flush(committer, on_done, (void *)&behind);
    assert_string_equal(told, "1+");
    while (!committer_is_idle(committer) || !strchr(told, '3'))
        uv_run(&loop, UV_RUN_ONCE);
    assert_string_equal(told, "1+ 2+ 3+");
    // The id is in use: the batch fails, the flush is called back, and an empty commit does not hide the trouble.
    put(committer, COMMIT_OR_DROP, 1, &put_one);
    committer_flush(committer, on_done, (void *)&behind);
    while (!committer_trouble(committer) || !strchr(told + 8, '3'))
        uv_run(&loop, UV_RUN_ONCE);
    assert_string_equal(told, "1+ 2+ 3+ 2- 3+");
    assert_true(committer_is_idle(committer));
    assert_non_null(committer_trouble(committer));
    put(committer, COMMIT_CERTAIN, 2, &later);
    while (!committer_is_idle(committer))
        uv_run(&loop, UV_RUN_ONCE);
    assert_string_equal(told, "1+ 2+ 3+ 2- 3+ 4+");
    assert_null(committer_trouble(committer));
    finish(&loop, committer, store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(callbacks_come_in_order_after_the_commit, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_flush_waits_for_the_ops_before_it, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_failed_batch_is_reported_dropped_or_kept_by_policy, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(a_lasting_failure_is_reported_to_later_ops, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
