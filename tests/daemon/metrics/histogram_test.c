// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics/histogram.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void an_end_belongs_to_its_class(void **state)
{
    const struct histogram_scale scale = {{1, 2, 5}, 3};
    struct histogram histogram = {0};
    static const double values[] = {0, 1, 1.5, 2, 5, 5.1, 1e6};

    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        histogram_add(&histogram, &scale, values[i]);
    assert_int_equal(histogram.counts[0], 2);
    assert_int_equal(histogram.counts[1], 2);
    assert_int_equal(histogram.counts[2], 1);
    assert_int_equal(histogram.counts[3], 2);
    assert_true(fabs(histogram.sum - 1000014.6) < 1e-6);
}

static void no_value_spoils_the_sum(void **state)
{
    const struct histogram_scale scale = {{1, 2, 5}, 3};
    struct histogram histogram = {0};

    histogram_add(&histogram, &scale, -1);
    histogram_add(&histogram, &scale, NAN);
    histogram_add(&histogram, &scale, INFINITY);
    assert_int_equal(histogram.counts[0], 2);
    assert_int_equal(histogram.counts[3], 1);
    assert_true(histogram.sum == 1e9);
}

static void scales_ascend(void **state)
{
    const struct histogram_scale *scales[] = {&histogram_work_s, &histogram_latency_s, &histogram_wait_s,
                                              &histogram_ratio};

    for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++) {
        assert_in_range(scales[i]->count, 1, HISTOGRAM_END_LIMIT);
        for (size_t k = 1; k < scales[i]->count; k++)
            assert_true(scales[i]->ends[k] > scales[i]->ends[k - 1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_end_belongs_to_its_class),
        cmocka_unit_test(no_value_spoils_the_sum),
        cmocka_unit_test(scales_ascend),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
