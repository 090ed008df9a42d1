// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/pool_access.h"
#include "daemon/settings/options.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

enum { LOCAL = POOL_ACCESS_LOCAL, BIG = 2, NEW = 4 };

struct fixture {
    struct options options;
    struct farm farm;
};

static int create(void **state)
{
    struct fixture *fixture = xcalloc(1, sizeof *fixture);
    struct pool_table *pools = &fixture->options.pools;

    fixture->farm = (struct farm){.options = &fixture->options, .queue = queue_create(3), .rights.admin_gid = -1};
    fixture->options.worker_count = 1;
    assert_true(pool_table_add(pools, "big nodes=a command=x tags=gpu", NULL));
    assert_true(pool_table_add(pools, "new nodes=b command=x tags=gpu,fast users=anna", NULL));
    assert_true(pool_table_add(pools, "local tags=cpu users=anna,ben", NULL));
    *state = fixture;
    return 0;
}

static int destroy(void **state)
{
    struct fixture *fixture = *state;

    job_table_finish(&fixture->farm.jobs);
    quota_finish(&fixture->farm.quota);
    queue_destroy(fixture->farm.queue);
    pool_table_finish(&fixture->options.pools);
    free(fixture);
    return 0;
}

// A user without groups.
static struct quota_user *note(struct fixture *fixture, int64_t uid, const char *name)
{
    struct quota_user *user = quota_find_user(&fixture->farm.quota, uid, name);

    pool_access_note_user(&fixture->farm, user, &(struct rights_peer){.uid = uid});
    return user;
}

static void pools_are_found_by_name_and_tag(void **state)
{
    struct fixture *fixture = *state;

    assert_int_equal(pool_access_find(&fixture->farm, NULL), LOCAL | BIG | NEW);
    assert_int_equal(pool_access_find(&fixture->farm, "new"), NEW);
    assert_int_equal(pool_access_find(&fixture->farm, "gpu"), BIG | NEW);
    assert_int_equal(pool_access_find(&fixture->farm, "cpu"), LOCAL);
    assert_int_equal(pool_access_find(&fixture->farm, "local"), LOCAL);
    assert_int_equal(pool_access_find(&fixture->farm, "ne"), 0);
    fixture->options.worker_count = -1;
    assert_int_equal(pool_access_find(&fixture->farm, "local"), 0);
    assert_int_equal(pool_access_all(&fixture->farm), BIG | NEW);
}

static void jobs_are_barred_from_pools_that_are_not_for_their_owner(void **state)
{
    struct fixture *fixture = *state;
    const struct quota_user *anna = note(fixture, 1, "anna"), *ben = note(fixture, 2, "ben");
    const struct quota_user *carl = note(fixture, 3, "carl");

    assert_int_equal(pool_access_find_barred(&fixture->farm, anna, NULL), 0);
    assert_true(pool_access_find_barred(&fixture->farm, anna, "gpu") == ~(uint64_t)(BIG | NEW));
    assert_true(pool_access_find_barred(&fixture->farm, ben, NULL) == ~(uint64_t)(LOCAL | BIG));
    assert_true(pool_access_find_barred(&fixture->farm, ben, "gpu") == ~(uint64_t)BIG);
    assert_true(pool_access_find_barred(&fixture->farm, carl, NULL) == ~(uint64_t)BIG);
    assert_true(pool_access_find_barred(&fixture->farm, carl, "fast") == ~UINT64_C(0));
}

static void administrators_may_use_all_pools(void **state)
{
    struct fixture *fixture = *state;
    struct quota_user *carl = note(fixture, 3, "carl");

    carl->is_unlimited = true;
    assert_int_equal(pool_access_find_barred(&fixture->farm, note(fixture, 3, "carl"), NULL), 0);
}

static void assert_refused(struct fixture *fixture, const char *user, const char *pool, const char *expected)
{
    struct error error = {0};

    assert_false(pool_access_check(&fixture->farm, note(fixture, 9, user), pool, &error));
    assert_string_equal(error.message, expected);
}

static void a_refusal_names_the_pools_that_there_are_or_their_users(void **state)
{
    struct fixture *fixture = *state;

    assert_true(pool_access_check(&fixture->farm, note(fixture, 9, "dora"), "gpu", NULL));
    assert_refused(fixture, "anna", "hpc",
                   "there is no pool or tag \"hpc\" here: pools are local, big, new; tags are cpu, gpu, fast");
    assert_refused(fixture, "dora", "fast", "dora may not use \"fast\": new is for anna");
    fixture->options.pools.pools[0].name[0] = 'p';
    assert_true(pool_terms_read_users(&fixture->options.pools.pools[0].terms, "ben", NULL));
    assert_refused(fixture, "dora", "gpu", "dora may not use \"gpu\": pig is for ben; new is for anna");
    assert_refused(fixture, "dora", NULL,
                   "dora may use no pool of this farm: local is for anna, ben; pig is for ben; new is for anna");
}

static void a_refresh_looks_at_all_jobs(void **state)
{
    struct fixture *fixture = *state;
    struct frame_range frames = {0};
    struct output_path path;
    struct job_record *record;

    assert_true(output_path_parse(&path, "a/a.#.exr", NULL));
    assert_true(frame_range_parse(&frames, "1-9", NULL));
    record = job_table_add(&fixture->farm.jobs, 1, xstrdup("/out"), &path);
    record->user = quota_find_user(&fixture->farm.quota, 4711, "no-such-user");
    record->pool = xstrdup("gpu");
    record->queued = queue_add_job(fixture->farm.queue, &(struct queue_job_params){.id = 1, .frames = &frames});
    pool_access_refresh(&fixture->farm);
    assert_true(record->queued->turn.barred == ~(uint64_t)BIG);
    assert_null(queue_choose_job(fixture->farm.queue, NULL));
    assert_ptr_equal(queue_choose_job(fixture->farm.queue, &(struct turns_seat){.kind = 1}), record->queued);
    pool_terms_finish(&fixture->options.pools.pools[0].terms);
    pool_access_refresh(&fixture->farm);
    assert_null(queue_choose_job(fixture->farm.queue, &(struct turns_seat){.kind = 1}));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(pools_are_found_by_name_and_tag, create, destroy),
        cmocka_unit_test_setup_teardown(jobs_are_barred_from_pools_that_are_not_for_their_owner, create, destroy),
        cmocka_unit_test_setup_teardown(administrators_may_use_all_pools, create, destroy),
        cmocka_unit_test_setup_teardown(a_refusal_names_the_pools_that_there_are_or_their_users, create, destroy),
        cmocka_unit_test_setup_teardown(a_refresh_looks_at_all_jobs, create, destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
