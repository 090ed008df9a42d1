// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics/metrics.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static uint64_t sum_of(const struct histogram *histogram)
{
    uint64_t sum = 0;

    for (size_t i = 0; i <= HISTOGRAM_END_LIMIT; i++)
        sum += histogram->counts[i];
    return sum;
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
        cmocka_unit_test(frames_are_counted_by_what_rendered_them),
        cmocka_unit_test(unknown_words_are_one_word),
        cmocka_unit_test(further_series_share_the_last),
        cmocka_unit_test(every_cause_and_fault_has_a_name),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
