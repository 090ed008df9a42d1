// SPDX-License-Identifier: Apache-2.0
#include "reference/transfer_function.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct scene_transfer_point POINTS[] = {
    {-1.0, {0.0, 0.2, 1.0, 0.0}},
    {1.0, {1.0, 0.2, 0.0, 0.5}},
    {2.0, {1.0, 1.0, 1.0, 1.0 - 1e-6}},
    {3.0, {0.0, 0.0, 0.0, 0.0}},
};
static const struct transfer_function TRANSFER = {POINTS, 4, 0.01};

static void opacity_of_the_unit_distance_is_that_of_the_point(void **state)
{
    for (size_t i = 0; i < 4; i++) {
        double sigma_t = transfer_function_extinction(&TRANSFER, POINTS[i].value);

        assert_near(1.0 - exp(-sigma_t * 0.01), POINTS[i].rgba[3], 1e-15);
    }
}

static void colour_and_opacity_are_linear_between_points(void **state)
{
    double rgb[3];

    transfer_function_color(&TRANSFER, 0.5, rgb);
    assert_near(rgb[0], 0.75, 1e-15);
    assert_near(rgb[1], 0.2, 1e-15);
    assert_near(rgb[2], 0.25, 1e-15);
    assert_near(transfer_function_extinction(&TRANSFER, 0.5), -log(1.0 - 0.375) / 0.01, 1e-12);
}

static void outer_points_hold(void **state)
{
    double rgb[3];

    transfer_function_color(&TRANSFER, -7.0, rgb);
    assert_near(rgb[2], 1.0, 0.0);
    transfer_function_color(&TRANSFER, 7.0, rgb);
    assert_near(rgb[0], 0.0, 0.0);
    assert_near(transfer_function_extinction(&TRANSFER, 7.0), 0.0, 0.0);
}

static void clear_is_where_no_value_is_opaque(void **state)
{
    assert_true(transfer_function_is_clear(&TRANSFER, -5.0, -1.0));
    assert_true(transfer_function_is_clear(&TRANSFER, 3.0, 9.0));
    assert_false(transfer_function_is_clear(&TRANSFER, -1.0, -0.9));
    // Both ends are clear; a value between them is not.
    assert_false(transfer_function_is_clear(&TRANSFER, -2.0, 4.0));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opacity_of_the_unit_distance_is_that_of_the_point),
        cmocka_unit_test(colour_and_opacity_are_linear_between_points),
        cmocka_unit_test(outer_points_hold),
        cmocka_unit_test(clear_is_where_no_value_is_opaque),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
