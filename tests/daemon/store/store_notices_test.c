// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_reader.h"

#include "tests/daemon/store/store_fixture.h"

static struct store_op notice_op(int64_t id, const char *target, bool is_webhook)
{
    return (struct store_op){.kind = STORE_ADD_NOTICE,
                             .notice = {.id = id,
                                        .job = 3,
                                        .owner_uid = 1000,
                                        .made_ms = 1700000000123,
                                        .event = xstrdup("done"),
                                        .target = xstrdup(target),
                                        .is_webhook = is_webhook,
                                        .body = xstrdup("{\"id\":1}")}};
}

static struct store_op told_op(int64_t job, int cause, int64_t told_ms, bool is_on)
{
    return (struct store_op){.kind = STORE_SET_TOLD,
                             .told = {.job = job, .cause = cause, .told_ms = told_ms, .is_on = is_on}};
}

static bool on_notice(void *user, const struct store_notice *notice, struct error *error)
{
    size_t length = strlen(user);

    assert_int_equal(notice->job, 3);
    assert_int_equal(notice->owner_uid, 1000);
    assert_true(notice->made_ms == 1700000000123);
    snprintf((char *)user + length, 256 - length, "%lld %s %s%s %s; ", (long long)notice->id, notice->event,
             notice->target, notice->is_webhook ? "!" : "", notice->body ? notice->body : "-");
    return true;
}

static bool on_told(void *user, const struct store_told *told, struct error *error)
{
    size_t length = strlen(user);

    snprintf((char *)user + length, 256 - length, "%lld %d %lld %d; ", (long long)told->job, told->cause,
             (long long)told->told_ms, told->is_on);
    return true;
}

static void expect_notices(const struct folder *folder, int64_t after, int limit, const char *expected)
{
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    struct error error = {0};
    char text[256] = "";

    assert_non_null(reader);
    if (!store_read_notices(reader, after, limit, on_notice, text, &error)) fail_msg("%s", error.message);
    assert_string_equal(text, expected);
    store_reader_close(reader);
}

static void expect_told(const struct folder *folder, const char *expected)
{
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    char text[256] = "";

    assert_non_null(reader);
    assert_true(store_read_told(reader, on_told, text, NULL));
    assert_string_equal(text, expected);
    store_reader_close(reader);
}

static void notices_are_read_in_order_until_they_are_dropped(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);

    commit_one(store, notice_op(4, "chat", false));
    commit_one(store, notice_op(7, "https://a/", true));
    commit_one(store, notice_op(9, "chat", false));
    store_close(store);
    store = open_store(folder); // a restart keeps them
    expect_notices(folder, 0, 10, "4 done chat {\"id\":1}; 7 done https://a/! {\"id\":1}; 9 done chat {\"id\":1}; ");
    expect_notices(folder, 4, 1, "7 done https://a/! {\"id\":1}; ");
    expect_notices(folder, 9, 10, "");
    commit_one(store, (struct store_op){.kind = STORE_DROP_NOTICE, .notice.id = 7});
    commit_one(store, (struct store_op){.kind = STORE_DROP_NOTICE, .notice.id = 8}); // there is none
    expect_notices(folder, 0, 10, "4 done chat {\"id\":1}; 9 done chat {\"id\":1}; ");
    store_close(store);
}

static void a_change_and_its_notice_are_one(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_op ops[2] = {{.kind = STORE_SET_JOB, .job.id = 3}, notice_op(1, "chat", false)};

    assert_false(commit(store, ops, 2, NULL)); // there is no job 3
    expect_notices(folder, 0, 10, "");
    commit_one(store, job_op(3));
    ops[0] = (struct store_op){.kind = STORE_SET_JOB, .job.id = 3};
    ops[1] = notice_op(1, "chat", false);
    assert_true(commit(store, ops, 2, NULL));
    expect_notices(folder, 0, 10, "1 done chat {\"id\":1}; ");
    store_close(store);
}

static void what_a_job_told_ends_with_it_and_its_notices_stay(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);

    commit_one(store, job_op(3));
    commit_one(store, notice_op(1, "chat", false));
    commit_one(store, told_op(3, 1, 5000, true));
    commit_one(store, told_op(3, 0, 6000, true));
    commit_one(store, told_op(3, 1, 5000, false));
    commit_one(store, told_op(4, 0, 7000, true));
    expect_told(folder, "3 0 6000 1; 3 1 5000 0; 4 0 7000 1; ");
    commit_one(store, (struct store_op){.kind = STORE_DELETE_JOB, .job.id = 3});
    expect_told(folder, "4 0 7000 1; ");
    expect_notices(folder, 0, 10, "1 done chat {\"id\":1}; ");
    store_close(store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(notices_are_read_in_order_until_they_are_dropped, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_change_and_its_notice_are_one, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_a_job_told_ends_with_it_and_its_notices_stay, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
