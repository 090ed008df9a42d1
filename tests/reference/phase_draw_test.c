// SPDX-License-Identifier: Apache-2.0
#include "reference/phase_draw.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { DRAWS = 200 * 1000, BINS = 16, PIECES = 200 };

// The share of directions whose cosine lies in a bin, by the phase itself.
static double share_of(const struct medium *medium, int bin)
{
    double sum = 0.0;

    for (int i = 0; i < PIECES; i++)
        sum += medium_phase(medium, -1.0 + 2.0 * (bin + (i + 0.5) / PIECES) / BINS);
    return 2.0 * M_PI * sum * 2.0 / BINS / PIECES;
}

// 5 standard errors of a count.
static void check(const struct medium *medium)
{
    int counts[BINS] = {0};
    struct stream stream = stream_of(1, 2);

    for (int i = 0; i < DRAWS; i++) {
        double cosine = phase_draw_cosine(medium, &stream);
        int bin = (int)(0.5 * (cosine + 1.0) * BINS);

        assert_true(cosine >= -1.0 && cosine <= 1.0);
        counts[bin < BINS ? bin : BINS - 1]++;
    }
    for (int bin = 0; bin < BINS; bin++) {
        double share = share_of(medium, bin);

        assert_near(counts[bin] / (double)DRAWS, share, 5.0 * sqrt(share / DRAWS) + 1e-4);
    }
}

static void cosines_are_as_frequent_as_the_phase_says(void **state)
{
    static const double GS[] = {0.0, 1e-9, 0.3, -0.499, 0.501, -0.8, 0.9};
    struct medium medium = {.lobe_count = 0};

    check(&medium);
    medium.lobe_count = 1;
    for (size_t i = 0; i < sizeof GS / sizeof GS[0]; i++) {
        medium.lobes[0] = (struct medium_lobe){SCENE_LOBE_HENYEY_GREENSTEIN, GS[i], 1.0};
        check(&medium);
    }
    medium.lobes[0] = (struct medium_lobe){.kind = SCENE_LOBE_RAYLEIGH, .weight = 1.0};
    check(&medium);
}

static void lobes_are_drawn_by_their_weights(void **state)
{
    struct medium medium = {.lobe_count = 3};

    medium.lobes[0] = (struct medium_lobe){SCENE_LOBE_HENYEY_GREENSTEIN, 0.7, 0.5};
    medium.lobes[1] = (struct medium_lobe){.kind = SCENE_LOBE_RAYLEIGH, .weight = 0.2};
    medium.lobes[2] = (struct medium_lobe){SCENE_LOBE_HENYEY_GREENSTEIN, -0.6, 0.3};
    check(&medium);
}

static void turns_about_an_axis_are_even(void **state)
{
    static const struct vec3 AXES[] = {{0.0, 0.0, 1.0}, {0.0, 0.0, -1.0}, {0.6, -0.8, 0.0}, {-0.48, 0.6, -0.64}};
    struct stream stream = stream_of(3, 4);

    for (size_t k = 0; k < sizeof AXES / sizeof AXES[0]; k++) {
        struct vec3 sum = {0.0, 0.0, 0.0};

        for (int i = 0; i < DRAWS / 10; i++) {
            struct vec3 drawn = phase_draw_about(AXES[k], 0.3, &stream);

            assert_near(vec3_length(drawn), 1.0, 1e-12);
            assert_near(vec3_dot(drawn, AXES[k]), 0.3, 1e-12);
            sum = vec3_add(sum, vec3_scale(drawn, 10.0 / DRAWS));
        }
        assert_near(vec3_length(vec3_subtract(sum, vec3_scale(AXES[k], 0.3))), 0.0, 5.0 / sqrt(DRAWS / 10));
    }
}

// Streams of a seed do not repeat each other, nor do seeds.
static void streams_are_apart(void **state)
{
    enum { STREAMS = 2000 };
    double sum = 0.0, product = 0.0, before = 0.5;

    for (uint64_t i = 0; i < STREAMS; i++) {
        struct stream stream = stream_of(i % 2, i / 2);
        double first = stream_draw(&stream);

        assert_true(first >= 0.0 && first < 1.0);
        sum += first;
        product += (first - 0.5) * (before - 0.5);
        before = first;
    }
    assert_near(sum / STREAMS, 0.5, 5.0 / sqrt(12.0 * STREAMS));
    assert_near(product / STREAMS, 0.0, 5.0 / 12.0 / sqrt(STREAMS));
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cosines_are_as_frequent_as_the_phase_says),
        cmocka_unit_test(lobes_are_drawn_by_their_weights),
        cmocka_unit_test(turns_about_an_axis_are_even),
        cmocka_unit_test(streams_are_apart),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
