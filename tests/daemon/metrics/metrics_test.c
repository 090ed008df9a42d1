// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics/metrics.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t sum_of(const struct histogram *histogram)
{
    uint64_t sum = 0;

    for (size_t i = 0; i <= HISTOGRAM_END_LIMIT; i++)
        sum += histogram->counts[i];
    return sum;
}

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

static void frames_are_counted_by_what_rendered_them(void **state)
{
    struct metrics *metrics = calloc(1, sizeof *metrics);
    const struct metrics_source here = {.pool = 0, .backend = "egl", .method = "cached"};
    const struct metrics_source there = {.pool = 2, .backend = "osmesa", .method = "draft"};

    metrics_note_frame(metrics, &here, 1.5, 0.5);
    metrics_note_frame(metrics, &there, 3, -1);
    metrics_note_frame(metrics, &here, 2.5, 0.9);
    assert_int_equal(metrics->frame_count, 2);
    assert_int_equal(sum_of(&metrics->frames[0].seconds), 2);
    assert_true(metrics->frames[0].seconds.sum == 4);
    assert_int_equal(sum_of(&metrics->frames[0].error), 2);
    assert_string_equal(metrics_backend_name(metrics->frames[0].backend), "egl");
    assert_string_equal(metrics_method_name(metrics->frames[0].method), "cached");
    assert_int_equal(metrics->frames[1].pool, 2);
    assert_int_equal(sum_of(&metrics->frames[1].error), 0);
    assert_string_equal(metrics_method_name(metrics->frames[1].method), "draft");
    free(metrics);
}

static void unknown_words_are_one_word(void **state)
{
    struct metrics *metrics = calloc(1, sizeof *metrics);

    for (int i = 0; i < 1000; i++) {
        char word[16];

        snprintf(word, sizeof word, "w%d", i);
        metrics_note_frame(metrics, &(struct metrics_source){.backend = word, .method = word}, 1, 1);
    }
    metrics_note_frame(metrics, &(struct metrics_source){0}, 1, 1);
    assert_int_equal(metrics->frame_count, 1);
    assert_string_equal(metrics_backend_name(metrics->frames[0].backend), "other");
    assert_string_equal(metrics_method_name(metrics->frames[0].method), "other");
    free(metrics);
}

// All that pools, backends and methods can be together is more than there are series.
static void further_series_share_the_last(void **state)
{
    static const char *const methods[] = {"riemann", "midpoint", "cached", "gauss", "tracking"};
    struct metrics *metrics = calloc(1, sizeof *metrics);
    uint64_t sum = 0;

    for (int pool = 0; pool < TURNS_KIND_LIMIT; pool++)
        for (int i = 0; i < 5; i++)
            metrics_note_frame(metrics, &(struct metrics_source){.pool = pool, .backend = "egl", .method = methods[i]},
                               1, 1);
    assert_int_equal(metrics->frame_count, METRICS_SERIES_LIMIT);
    assert_int_equal(sum_of(&metrics->frames[METRICS_SERIES_LIMIT].seconds),
                     TURNS_KIND_LIMIT * 5 - METRICS_SERIES_LIMIT);
    for (int i = 0; i <= METRICS_SERIES_LIMIT; i++)
        sum += sum_of(&metrics->frames[i].seconds);
    assert_int_equal(sum, TURNS_KIND_LIMIT * 5);
    free(metrics);
}

static void every_cause_and_fault_has_a_name(void **state)
{
    for (int i = 0; i < METRICS_END_COUNT; i++)
        assert_non_null(metrics_end_names[i]);
    for (int i = 0; i < METRICS_FAULT_COUNT; i++)
        assert_non_null(retry_fault_names[i]);
    assert_null(retry_fault_names[METRICS_FAULT_COUNT]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_end_belongs_to_its_class),
        cmocka_unit_test(no_value_spoils_the_sum),
        cmocka_unit_test(scales_ascend),
        cmocka_unit_test(frames_are_counted_by_what_rendered_them),
        cmocka_unit_test(unknown_words_are_one_word),
        cmocka_unit_test(further_series_share_the_last),
        cmocka_unit_test(every_cause_and_fault_has_a_name),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
