// The estimate of an error from measured pixels, its spread and its bound.
// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/audit_estimate.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static struct audit_samples even_samples(size_t count, double square, double cross)
{
    struct audit_samples samples = {0};

    for (size_t i = 0; i < count; i++)
        audit_samples_append(&samples, &(struct audit_sample){.square = square, .cross = cross});
    return samples;
}

static void errors_are_relative_to_the_light(void **state)
{
    // The frame is the light times 1.25: relative to its mean square the squared error is 0.04, and the cross term 0.2.
    struct audit_samples own = even_samples(64, 0.04, 0.2);
    struct audit_verdict verdict = audit_estimate(&(struct audit_evidence){.own = &own, .change = -1.0});

    assert_near(verdict.error, 0.25, 1e-9);
    assert_true(verdict.error95 > verdict.error);
    verdict = audit_estimate(&(struct audit_evidence){.own = &own, .change = -1.0, .is_black = true});
    assert_near(verdict.error, 0.2, 1e-9);
    audit_samples_finish(&own);
}

static void spreads_are_standard_errors(void **state)
{
    // Squares of 1e-4 and 3e-4 in turn: their mean has a standard error of 1e-4 / sqrt(63).
    struct audit_samples own = even_samples(64, 1e-4, 0.0);
    struct audit_verdict verdict;

    for (size_t i = 0; i < own.count; i += 2)
        own.list[i].square = 3e-4;
    verdict = audit_estimate(&(struct audit_evidence){.own = &own, .change = -1.0, .is_black = true});
    assert_near(verdict.error, sqrt(2e-4), 1e-9);
    assert_near(verdict.spread, sqrt(2e-4 + 1e-4 / sqrt(63.0)) - sqrt(2e-4), 1e-9);
    audit_samples_finish(&own);
}

static void changes_by_halving_are_below_the_bound(void **state)
{
    struct audit_samples own = even_samples(64, 1e-8, 0.0);
    struct audit_evidence evidence = {.own = &own, .change = 0.03, .resolution = 1e-3};

    assert_true(audit_estimate(&evidence).error95 >= 0.03);
    evidence.change = -1.0;
    assert_true(audit_estimate(&evidence).error95 >= 1e-3);
    assert_true(audit_estimate(&evidence).error95 < 2e-3);
    audit_samples_finish(&own);
}

static void a_frame_unlike_its_pool_is_judged_by_itself(void **state)
{
    struct audit_samples pool = even_samples(64, 1e-6, 0.0), own = even_samples(8, 1e-6, 0.0);
    struct audit_evidence evidence = {.own = &own, .pool = &pool, .change = -1.0, .pool_change = -1.0};
    struct audit_verdict verdict;

    for (size_t i = 0; i < pool.count; i++)
        pool.list[i].square *= i % 2 ? 1.5 : 0.5;
    verdict = audit_estimate(&evidence);
    assert_true(verdict.is_pooled);
    assert_int_equal(verdict.ray_count, 72);
    assert_near(verdict.error, 1e-3, 1e-6);
    // Halving changes this frame more than the pool's.
    evidence.change = 0.004;
    evidence.pool_change = 0.001;
    verdict = audit_estimate(&evidence);
    assert_true(verdict.is_pooled);
    assert_near(verdict.error, 4e-3, 1e-4);
    own.list[5].square = 1e-3;
    verdict = audit_estimate(&evidence);
    assert_false(verdict.is_pooled);
    assert_int_equal(verdict.ray_count, 8);
    assert_true(verdict.error > 0.01);
    audit_samples_finish(&pool);
    audit_samples_finish(&own);
}

// Squares with the noise of random paths have a largest one by chance: twice the pool's is none of a broken frame.
static void the_largest_of_random_squares_may_be_above_the_pool(void **state)
{
    struct audit_samples pool = even_samples(64, 1e-6, 0.0), own = even_samples(32, 1e-6, 0.0);
    struct audit_evidence evidence = {.own = &own, .pool = &pool, .change = -1.0, .pool_change = -1.0};

    for (size_t i = 0; i < pool.count; i++)
        pool.list[i].square *= i % 2 ? 1.5 : 0.5;
    own.list[5].square = 2.9e-6;
    assert_false(audit_estimate(&evidence).is_pooled);
    evidence.is_random = true;
    assert_true(audit_estimate(&evidence).is_pooled);
    own.list[5].square = 3.1e-6;
    assert_false(audit_estimate(&evidence).is_pooled);
    audit_samples_finish(&pool);
    audit_samples_finish(&own);
}

static void values_that_are_not_finite_are_infinite_errors(void **state)
{
    struct audit_samples own = even_samples(64, 1e-6, 0.0);

    own.list[9].square = NAN;
    assert_true(isinf(audit_estimate(&(struct audit_evidence){.own = &own, .change = -1.0}).error95));
    audit_samples_finish(&own);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_relative_to_the_light),
        cmocka_unit_test(spreads_are_standard_errors),
        cmocka_unit_test(changes_by_halving_are_below_the_bound),
        cmocka_unit_test(a_frame_unlike_its_pool_is_judged_by_itself),
        cmocka_unit_test(the_largest_of_random_squares_may_be_above_the_pool),
        cmocka_unit_test(values_that_are_not_finite_are_infinite_errors),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
