// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_reader.h"

#include "tests/daemon/store/store_fixture.h"

static struct store_op plan_op(int64_t number, int64_t owner_uid, const char *segment, const char *text)
{
    struct store_op op = {.kind = STORE_ADD_PLAN,
                          .plan = {.number = number, .key = {.owner_uid = owner_uid, .scene = "aa"}}};

    snprintf(op.plan.key.segment, sizeof op.plan.key.segment, "%s", segment);
    op.plan.text = xstrdup(text);
    return op;
}

static void expect_plan(const struct folder *folder, const struct plan_key *key, int64_t number, const char *text)
{
    struct store_reader *reader = store_reader_open(folder->path, NULL);
    struct error error = {0};
    int64_t found_number;
    char *found;

    assert_non_null(reader);
    if (!store_read_plan(reader, key, &found_number, &found, &error)) fail_msg("%s", error.message);
    assert_int_equal(found_number, number);
    if (text)
        assert_string_equal(found, text);
    else
        assert_null(found);
    free(found);
    store_reader_close(reader);
}

static void the_newest_plan_of_its_owner_scene_and_segment_is_found(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);

    assert_int_equal(store_next_plan_number(store), 1);
    commit_one(store, plan_op(1, 7, "bb", "one"));
    commit_one(store, plan_op(2, 8, "bb", "other owner"));
    commit_one(store, plan_op(3, 7, "cc", "other segment"));
    commit_one(store, plan_op(4, 7, "bb", "next"));
    store_close(store);
    store = open_store(folder); // a restart keeps them
    assert_int_equal(store_next_plan_number(store), 5);
    expect_plan(folder, &(struct plan_key){7, "aa", "bb"}, 4, "next");
    expect_plan(folder, &(struct plan_key){8, "aa", "bb"}, 2, "other owner");
    expect_plan(folder, &(struct plan_key){7, "aa", "cc"}, 3, "other segment");
    expect_plan(folder, &(struct plan_key){7, "ab", "bb"}, 0, NULL);
    expect_plan(folder, &(struct plan_key){9, "aa", "bb"}, 0, NULL);
    store_close(store);
}

static void the_oldest_plans_of_an_owner_are_dropped(void **state)
{
    const struct folder *folder = *state;
    struct store *store = open_store(folder);
    struct store_op *ops = xcalloc(STORE_PLAN_LIMIT + 2, sizeof *ops);

    ops[0] = plan_op(1, 8, "bb", "another owner's");
    ops[1] = plan_op(2, 7, "bb", "oldest");
    ops[2] = plan_op(3, 7, "cc", "older");
    for (int i = 3; i < STORE_PLAN_LIMIT + 2; i++)
        ops[i] = plan_op(i + 1, 7, "dd", "later");
    assert_true(commit(store, ops, STORE_PLAN_LIMIT + 2, NULL));
    commit_one(store, plan_op(STORE_PLAN_LIMIT + 3, 8, "ee", "another owner's next"));
    expect_plan(folder, &(struct plan_key){8, "aa", "bb"}, 1, "another owner's");
    expect_plan(folder, &(struct plan_key){7, "aa", "bb"}, 0, NULL);
    expect_plan(folder, &(struct plan_key){7, "aa", "cc"}, 3, "older");
    expect_plan(folder, &(struct plan_key){7, "aa", "dd"}, STORE_PLAN_LIMIT + 2, "later");
    store_close(store);
    free(ops);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_newest_plan_of_its_owner_scene_and_segment_is_found, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(the_oldest_plans_of_an_owner_are_dropped, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
