// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/quota.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const struct quota_amounts limits = {.jobs = 3, .frames = 1000, .pixels = 500000, .disk_bytes = 4096};

static void assert_refused(const struct quota_user *user, struct quota_amounts added, const char *message)
{
    struct error error = {0};

    if (quota_check(user, &limits, &added, "this job", &error)) fail_msg("accepted instead of: %s", message);
    assert_string_equal(error.message, message);
}

static void shares_are_summed_per_user(void **state)
{
    struct quota quota = {0};
    struct quota_user *bob = quota_find_user(&quota, 1001, "bob"), *ann = quota_find_user(&quota, 1000, "ann");
    struct quota_amounts first = {0}, second = {0}, third = {0};

    quota_set(ann, &first, (struct quota_amounts){1, 100, 6400, 10});
    quota_set(ann, &second, (struct quota_amounts){1, 50, 50, 0});
    quota_set(bob, &third, (struct quota_amounts){1, 7, 7, 7});
    assert_ptr_equal(quota_find_user(&quota, 1000, "ann"), ann);
    assert_int_equal(ann->has.jobs, 2);
    assert_int_equal(ann->has.frames, 150);
    assert_int_equal(ann->has.pixels, 6450);
    assert_int_equal(ann->has.disk_bytes, 10);
    assert_int_equal(bob->has.frames, 7);

    quota_set(ann, &first, (struct quota_amounts){0, 0, 0, 30});
    quota_set(ann, &second, (struct quota_amounts){1, 49, 49, 5});
    assert_int_equal(ann->has.jobs, 1);
    assert_int_equal(ann->has.frames, 49);
    assert_int_equal(ann->has.pixels, 49);
    assert_int_equal(ann->has.disk_bytes, 35);
    quota_set(ann, &first, (struct quota_amounts){0});
    quota_set(ann, &second, (struct quota_amounts){0});
    assert_int_equal(ann->has.jobs + ann->has.frames + ann->has.pixels + ann->has.disk_bytes, 0);
    quota_finish(&quota);
}

static void users_are_found_among_many(void **state)
{
    struct quota quota = {0};
    struct quota_amounts shares[100] = {{0}};

    for (int i = 0; i < 100; i++)
        quota_set(quota_find_user(&quota, i * 37 % 100, "x"), &shares[i], (struct quota_amounts){.jobs = i * 37 % 100});
    assert_int_equal(quota.count, 100);
    for (int i = 0; i < 100; i++)
        assert_int_equal(quota_find_user(&quota, i, "x")->has.jobs, i);
    quota_finish(&quota);
}

static void a_user_has_the_latest_name(void **state)
{
    struct quota quota = {0};

    quota_find_user(&quota, 1, "ann");
    assert_string_equal(quota_find_user(&quota, 1, "anna")->name, "anna");
    quota_finish(&quota);
}

static void the_limit_itself_is_allowed_and_one_more_is_not(void **state)
{
    struct quota_user user = {.name = (char *)"ann", .has = {.jobs = 2, .frames = 900, .pixels = 400000}};
    struct error error = {0};

    assert_true(quota_check(&user, &limits, &(struct quota_amounts){1, 100, 100000, 0}, "this job", &error));
    assert_refused(&user, (struct quota_amounts){1, 101, 1, 0},
                   "frames: ann may have 1000 unfinished frames, has 900, and this job adds 101");
    assert_refused(&user, (struct quota_amounts){1, 1, 100001, 0},
                   "resolution: ann may have 500000 pixels of unfinished frames, has 400000, and this job adds 100001");
    user.has.jobs = 3;
    assert_refused(&user, (struct quota_amounts){1, 1, 1, 0},
                   "jobs: ann may have 3 that are not over, has 3, and this job adds 1");
    // A retry of some frames of a job that is not over adds no job.
    assert_true(quota_check(&user, &limits, &(struct quota_amounts){0, 1, 1, 0}, "this retry", &error));
}

// The limit was lowered below what the user has.
static void a_user_over_the_limit_gets_no_more(void **state)
{
    struct quota_user user = {.name = (char *)"ann", .has = {.frames = INT64_MAX}};

    assert_refused(&user, (struct quota_amounts){1, 1, 1, 0},
                   "frames: ann may have 1000 unfinished frames, has 9223372036854775807, and this job adds 1");
    user.has.frames = 1;
    assert_refused(&user, (struct quota_amounts){1, INT64_MAX, 1, 0},
                   "frames: ann may have 1000 unfinished frames, has 1, and this job adds 9223372036854775807");
}

static void a_full_disk_takes_no_more_frames(void **state)
{
    struct quota_user user = {.name = (char *)"ann", .has = {.disk_bytes = 4095}};
    struct error error = {0};

    assert_true(quota_check(&user, &limits, &(struct quota_amounts){1, 1, 1, 0}, "this job", &error));
    assert_true(quota_check_disk(&user, &limits, &error));
    user.has.disk_bytes = 4096;
    assert_refused(
        &user, (struct quota_amounts){1, 1, 1, 0},
        "output: ann may have 4096 bytes of published files, has 4096: `march delete --files` of a job that is "
        "over makes room");
    assert_false(quota_check_disk(&user, &limits, &error));
}

static void without_limits_everything_is_allowed(void **state)
{
    const struct quota_amounts none = {0}, much = {1, INT64_MAX, INT64_MAX, 0};
    struct quota_user user = {.name = (char *)"ann", .has = {INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX}};
    struct error error = {0};

    assert_true(quota_check(&user, &none, &much, "this job", &error));
    assert_true(quota_check_disk(&user, &none, &error));
    user.is_unlimited = true;
    assert_true(quota_check(&user, &limits, &much, "this job", &error));
    assert_true(quota_check_disk(&user, &limits, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shares_are_summed_per_user),
        cmocka_unit_test(users_are_found_among_many),
        cmocka_unit_test(a_user_has_the_latest_name),
        cmocka_unit_test(the_limit_itself_is_allowed_and_one_more_is_not),
        cmocka_unit_test(a_user_over_the_limit_gets_no_more),
        cmocka_unit_test(a_full_disk_takes_no_more_frames),
        cmocka_unit_test(without_limits_everything_is_allowed),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
