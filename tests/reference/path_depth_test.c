// SPDX-License-Identifier: Apache-2.0
#include "reference/path_depth.h"

#include "tests/support/path_still.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// A ball of radius 1 and extinction 6, whose rim fades so that its density is one that varies.
static void fill(struct still *still)
{
    struct medium *medium;

    solid_still_init(still);
    medium = path_still_add_ball(still, (struct vec3){0.2, 0.0, 0.0}, 1.0, 5.0, 1.0);
    still->bounded[0].bounds.falloff = 0.01;
    medium->density = density_bounded(&still->bounded[0]);
}

// Cells of an eighth of the radius.
static void depths_are_those_of_chords(void **state)
{
    struct path_depth depth;
    struct still still;

    fill(&still);
    path_still_add_sun(&still, (struct vec3){1.0, 0.0, 0.0}, 1.0);
    path_still_add_point(&still, (struct vec3){0.2, 3.0, 0.0}, 1.0);
    still.spheres[still.sphere_count++] = (struct sphere_light){.center = {0.2, 0.1, -0.3}, .radius = 0.1};
    path_depth_init(&depth, &still);
    assert_float_equal(path_depth_at(&depth, 0, (struct vec3){0.7, 0.0, 0.0}), 6.0 * 1.5, 1.0);
    assert_float_equal(path_depth_at(&depth, 0, (struct vec3){-0.3, 0.0, 0.0}), 6.0 * 0.5, 1.0);
    assert_float_equal(path_depth_at(&depth, 1, (struct vec3){0.2, -0.5, 0.0}), 6.0 * 1.5, 1.0);
    assert_float_equal(path_depth_at(&depth, 2, (struct vec3){0.2, 0.1, 0.4}), 6.0 * 0.7, 1.0);
    assert_float_equal(path_depth_at(&depth, 0, (struct vec3){1.3, 0.0, 0.0}), 0.0, 0.0);
    path_depth_finish(&depth);
}

static void nothing_that_varies_has_no_depth(void **state)
{
    struct path_depth depth;
    struct still still;

    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 5.0, 1.0);
    path_still_add_sun(&still, (struct vec3){1.0, 0.0, 0.0}, 1.0);
    path_depth_init(&depth, &still);
    assert_null(depth.depths);
    assert_float_equal(path_depth_at(&depth, 0, (struct vec3){0.0, 0.0, 0.0}), 0.0, 0.0);
    path_depth_finish(&depth);
    fill(&still);
    path_depth_init(&depth, &still);
    assert_null(depth.depths);
    path_depth_finish(&depth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depths_are_those_of_chords),
        cmocka_unit_test(nothing_that_varies_has_no_depth),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
