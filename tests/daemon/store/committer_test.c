// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/committer.h"

#include "daemon/metrics/histogram.h"
#include "tests/daemon/store/store_fixture.h"

// The results of the callbacks, in order: "3+" when ops tagged 3 are on disk, "3-" for a failure.
static char told[256];

static void on_done(void *user, bool ok, const struct error *error)
{
    size_t length = strlen(told);

    snprintf(told + length, sizeof told - length, "%s%d%c", length ? " " : "", *(const int *)user, ok ? '+' : '-');
    assert_true(ok || error->message[0]);
}

struct stage {
    uv_loop_t loop;
    struct store *store;
    struct committer *committer;
};

static void open_stage(struct stage *stage, const struct folder *folder)
{
    told[0] = '\0';
    stage->store = open_store(folder);
    uv_loop_init(&stage->loop);
    stage->committer = committer_create(&stage->loop, stage->store);
}

static void close_stage(struct stage *stage)
{
    committer_close(stage->committer);
    uv_run(&stage->loop, UV_RUN_DEFAULT);
    committer_destroy(stage->committer);
    assert_int_equal(uv_loop_close(&stage->loop), 0);
    store_close(stage->store);
}

static void put(struct stage *stage, enum commit_policy policy, int64_t job, const int *tag)
{
    struct store_op op = job_op(job);

    committer_put(stage->committer, policy, &op, 1, on_done, (void *)tag);
}

static void flush(struct stage *stage, const int *tag)
{
    committer_flush(stage->committer, on_done, (void *)tag);
}

static void run_until_idle(struct stage *stage)
{
    while (!committer_is_idle(stage->committer))
        uv_run(&stage->loop, UV_RUN_ONCE);
}

static void run_until_trouble(struct stage *stage)
{
    while (!committer_trouble(stage->committer))
        uv_run(&stage->loop, UV_RUN_ONCE);
}

static int count_commits(const struct stage *stage)
{
    const struct histogram *seconds = committer_seconds(stage->committer);
    int count = 0;

    for (size_t i = 0; i <= HISTOGRAM_END_LIMIT; i++)
        count += (int)seconds->counts[i];
    return count;
}

static void callbacks_come_in_order_after_the_commit(void **state)
{
    static const int one = 1, two = 2, three = 3;
    struct stage stage;

    open_stage(&stage, *state);
    put(&stage, COMMIT_CERTAIN, 1, &one);
    put(&stage, COMMIT_REPORTED, 2, &two);
    put(&stage, COMMIT_OR_DROP, 3, &three);
    assert_int_equal(committer_waiting(stage.committer), 3);
    assert_string_equal(told, "");
    run_until_idle(&stage);
    assert_string_equal(told, "1+ 2+ 3+");
    assert_int_equal(load(stage.store).jobs, 3);
    assert_int_equal(count_commits(&stage), 2); // the second and the third wait for the first, and are one
    assert_true(committer_seconds(stage.committer)->sum > 0);
    close_stage(&stage);
}

// A change that waits for a store that fails takes as long as it waits: a try follows after a second.
static void what_waits_for_the_store_is_counted_when_it_is_there(void **state)
{
    static const int ten = 10, certain = 1, taken = 4;
    struct stage stage;

    open_stage(&stage, *state);
    put(&stage, COMMIT_CERTAIN, 10, &ten);
    put(&stage, COMMIT_CERTAIN, 1, &certain);
    put(&stage, COMMIT_OR_DROP, 10, &taken);
    run_until_trouble(&stage);
    assert_int_equal(count_commits(&stage), 1);
    run_until_idle(&stage);
    assert_int_equal(count_commits(&stage), 2);
    assert_true(committer_seconds(stage.committer)->sum > 0.9);
    close_stage(&stage);
}

// A job id that is in use makes the whole batch fail, as a full disk does.
static void a_failed_batch_is_reported_dropped_or_kept_by_policy(void **state)
{
    static const int ten = 10, certain = 1, reported = 2, dropped = 3, taken = 4;
    struct stage stage;

    open_stage(&stage, *state);
    put(&stage, COMMIT_CERTAIN, 10, &ten);
    put(&stage, COMMIT_CERTAIN, 1, &certain);
    put(&stage, COMMIT_REPORTED, 2, &reported);
    put(&stage, COMMIT_OR_DROP, 3, &dropped);
    put(&stage, COMMIT_OR_DROP, 10, &taken);
    run_until_trouble(&stage);
    assert_string_equal(told, "10+ 2- 3- 4-");
    assert_int_equal(load(stage.store).jobs, 1);
    assert_int_equal(committer_waiting(stage.committer), 2);
    run_until_idle(&stage);
    assert_string_equal(told, "10+ 2- 3- 4- 1+");
    assert_null(committer_trouble(stage.committer));
    assert_int_equal(load(stage.store).jobs, 3);
    close_stage(&stage);
}

// While failed ops wait for the next try, a new op is answered at once.
static void a_lasting_failure_is_reported_to_later_ops(void **state)
{
    static const int kept = 1, dropped = 2, reported = 3;
    struct stage stage;

    open_stage(&stage, *state);
    put(&stage, COMMIT_CERTAIN, 1, &kept);
    run_until_idle(&stage);
    // The id stays in use.
    put(&stage, COMMIT_CERTAIN, 1, &kept);
    run_until_trouble(&stage);
    put(&stage, COMMIT_OR_DROP, 2, &dropped);
    put(&stage, COMMIT_REPORTED, 3, &reported);
    while (!strchr(told, '3'))
        uv_run(&stage.loop, UV_RUN_ONCE);
    assert_string_equal(told, "1+ 2- 3-");
    assert_int_equal(committer_waiting(stage.committer), 2);
    assert_int_equal(load(stage.store).jobs, 1);
    // The ops that wait can never be committed, so the committer is destroyed with them.
    close_stage(&stage);
}

// The callback of a flush comes after the ops before it.
static void a_flush_waits_for_the_ops_before_it(void **state)
{
    static const int idle = 1, put_one = 2, behind = 3, later = 4;
    struct stage stage;

    open_stage(&stage, *state);
    flush(&stage, &idle);
    assert_string_equal(told, "1+");
    put(&stage, COMMIT_CERTAIN, 1, &put_one);
    flush(&stage, &behind);
    assert_string_equal(told, "1+");
    while (!committer_is_idle(stage.committer) || !strchr(told, '3'))
        uv_run(&stage.loop, UV_RUN_ONCE);
    assert_string_equal(told, "1+ 2+ 3+");
    // The id is in use: the batch fails, and the flush is called back.
    put(&stage, COMMIT_OR_DROP, 1, &put_one);
    flush(&stage, &behind);
    while (!strchr(told + 8, '3'))
        uv_run(&stage.loop, UV_RUN_ONCE);
    assert_string_equal(told, "1+ 2+ 3+ 2- 3+");
    put(&stage, COMMIT_CERTAIN, 2, &later);
    run_until_idle(&stage);
    assert_string_equal(told, "1+ 2+ 3+ 2- 3+ 4+");
    assert_null(committer_trouble(stage.committer));
    close_stage(&stage);
}

static int trouble_count;

static void on_trouble(void *user)
{
    (void)user;
    trouble_count++;
}

// Nothing is put after the failure: the committer tries by itself whether the store works again.
static void trouble_is_told_and_ends_without_new_ops(void **state)
{
    static const int one = 1, taken = 2;
    struct stage stage;

    open_stage(&stage, *state);
    committer_watch(stage.committer, on_trouble, NULL);
    put(&stage, COMMIT_CERTAIN, 1, &one);
    run_until_idle(&stage);
    assert_int_equal(trouble_count, 0);
    put(&stage, COMMIT_OR_DROP, 1, &taken);
    run_until_trouble(&stage);
    assert_int_equal(trouble_count, 1);
    assert_true(committer_has_failed(stage.committer));
    while (committer_trouble(stage.committer))
        uv_run(&stage.loop, UV_RUN_ONCE);
    assert_int_equal(trouble_count, 2);
    assert_false(committer_has_failed(stage.committer));
    close_stage(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(callbacks_come_in_order_after_the_commit, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_waits_for_the_store_is_counted_when_it_is_there, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(trouble_is_told_and_ends_without_new_ops, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_flush_waits_for_the_ops_before_it, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_failed_batch_is_reported_dropped_or_kept_by_policy, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(a_lasting_failure_is_reported_to_later_ops, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
