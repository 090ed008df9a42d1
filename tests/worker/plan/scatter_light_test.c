// What the light of some pixels says of its own noise.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_light.h"

#include "worker/audit/truth.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { COUNT = 100 };

static void fill(struct truth_pixel *pixels, double light, double half)
{
    for (int i = 0; i < COUNT; i++)
        pixels[i] = (struct truth_pixel){.rgb = {light, light, light}, .half = {half, half, half}};
}

static void noise_is_no_light(void **state)
{
    struct truth_pixel pixels[COUNT];

    fill(pixels, 2.0, 0.5);
    assert_float_equal(scatter_light_square(pixels, COUNT), 3.75, 1e-12);
    fill(pixels, 0.0, 0.5);
    assert_float_equal(scatter_light_square(pixels, COUNT), 0.0, 1e-12);
    (void)state;
}

static void dark_pixels_do_not_count(void **state)
{
    struct truth_pixel pixels[COUNT];

    fill(pixels, 0.0, 0.0);
    assert_float_equal(scatter_light_count(pixels, COUNT), COUNT, 1e-9);
    for (int i = 0; i < 7; i++)
        pixels[i].rgb[1] = 3.0;
    assert_float_equal(scatter_light_count(pixels, COUNT), 7.0, 1e-9);
    pixels[7].rgb[1] = 0.3;
    assert_true(scatter_light_count(pixels, COUNT) < 7.2);
    (void)state;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_no_light),
        cmocka_unit_test(dark_pixels_do_not_count),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
