// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/view_shrink.h"

#include "core/base/error.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { SIDE_LIMIT = 64 };

static const double SUM_TOLERANCE = 1e-5; // of sums of floats near 1

static void start(struct view_shrink *shrink, struct view_part part, int size, enum view_shrink_kind kind)
{
    struct error error = {0};

    if (!view_shrink_init(shrink, &part, size, kind, &error)) fail_msg("%s", error.message);
}

static void assert_value(const struct view_shrink *shrink, size_t pixel, size_t channel, double expected)
{
    float value = view_shrink_value(shrink, pixel, channel);

    if (!(fabs((double)value - expected) <= SUM_TOLERANCE))
        fail_msg("pixel %zu: expected %g, got %g", pixel, expected, (double)value);
}

static void constant_stays_what_it_is_at_any_size(void **state)
{
    float line[3 * SIDE_LIMIT];

    for (int i = 0; i < SIDE_LIMIT; i++) {
        line[i] = 0.25f;
        line[SIDE_LIMIT + i] = 0.5f;
        line[2 * SIDE_LIMIT + i] = 1.0f;
    }
    for (int size = 1; size <= SIDE_LIMIT + 1; size++) {
        struct view_shrink shrink;

        start(&shrink, (struct view_part){0, 0, SIDE_LIMIT, 37}, size, VIEW_SHRINK_THREE);
        for (int row = 0; row < 37; row++)
            view_shrink_add_line(&shrink, row, line, SIDE_LIMIT);
        assert_true(shrink.width_px <= size && shrink.height_px <= size);
        for (size_t i = 0; i < (size_t)shrink.width_px * (size_t)shrink.height_px; i++)
            for (size_t c = 0; c < 3; c++)
                assert_value(&shrink, i, c, 0.25 * (double)(1 << c));
        view_shrink_finish(&shrink);
    }
}

static void pixel_is_the_mean_of_what_it_covers(void **state)
{
    const float first[] = {0, 3, 6}, second[] = {12, 15, 18};
    struct view_shrink shrink;

    // Each of the two pixels covers one column and a half, and two rows.
    start(&shrink, (struct view_part){0, 0, 3, 2}, 2, VIEW_SHRINK_ONE);
    assert_int_equal(shrink.width_px, 2);
    assert_int_equal(shrink.height_px, 1);
    view_shrink_add_line(&shrink, 0, first, 3);
    view_shrink_add_line(&shrink, 1, second, 3);
    assert_value(&shrink, 0, 0, (0 + 1.5 + 12 + 7.5) / 3);
    assert_value(&shrink, 1, 0, (1.5 + 6 + 7.5 + 18) / 3);
    view_shrink_finish(&shrink);
}

static void part_is_cut_out_and_never_enlarged(void **state)
{
    struct view_shrink shrink;
    float line[8];

    start(&shrink, (struct view_part){2, 1, 3, 2}, 4096, VIEW_SHRINK_ONE);
    assert_int_equal(shrink.width_px, 3);
    assert_int_equal(shrink.height_px, 2);
    for (int row = 0; row < 4; row++) {
        for (int x = 0; x < 8; x++)
            line[x] = (float)(10 * row + x);
        view_shrink_add_line(&shrink, row, line, 8);
    }
    for (int i = 0; i < 6; i++)
        assert_value(&shrink, (size_t)i, 0, 10 * (1 + i / 3) + 2 + i % 3);
    view_shrink_finish(&shrink);
}

static void values_that_are_not_finite_count_as_0(void **state)
{
    const float line[] = {NAN, 1, INFINITY, -INFINITY};
    struct view_shrink shrink;

    start(&shrink, (struct view_part){0, 0, 4, 1}, 1, VIEW_SHRINK_ONE);
    view_shrink_add_line(&shrink, 0, line, 4);
    assert_value(&shrink, 0, 0, 0.25);
    view_shrink_finish(&shrink);
}

static void depth_is_the_mean_of_the_pixels_that_have_one(void **state)
{
    const float line[] = {0, 4, 6, 0, 0, 0};
    struct view_shrink shrink;

    start(&shrink, (struct view_part){0, 0, 6, 1}, 2, VIEW_SHRINK_DEPTH);
    view_shrink_add_line(&shrink, 0, line, 6);
    assert_value(&shrink, 0, 0, 5);
    assert_value(&shrink, 1, 0, 0);
    view_shrink_finish(&shrink);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_stays_what_it_is_at_any_size),
        cmocka_unit_test(pixel_is_the_mean_of_what_it_covers),
        cmocka_unit_test(part_is_cut_out_and_never_enlarged),
        cmocka_unit_test(values_that_are_not_finite_count_as_0),
        cmocka_unit_test(depth_is_the_mean_of_the_pixels_that_have_one),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
