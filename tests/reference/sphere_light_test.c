// SPDX-License-Identifier: Apache-2.0
#include "reference/sphere_light.h"

#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct sphere_light LAMP = {.center = {1.0, 2.0, 3.0}, .radius = 0.5, .radiance = {1.0, 1.0, 1.0}};

static double distance_from(struct vec3 origin, struct vec3 direction)
{
    return sphere_light_distance(&LAMP, &(struct ray){origin, vec3_normalize(direction)});
}

static void ray_meets_the_near_side(void **state)
{
    assert_near(distance_from((struct vec3){1.0, 2.0, 0.0}, (struct vec3){0.0, 0.0, 1.0}), 2.5, 1e-14);
    assert_near(distance_from((struct vec3){1.0, 2.3, 0.0}, (struct vec3){0.0, 0.0, 1.0}), 2.6, 1e-14);
    assert_true(isinf(distance_from((struct vec3){1.0, 2.5, 0.0}, (struct vec3){0.0, 0.0, 1.0})));
    assert_true(isinf(distance_from((struct vec3){1.0, 2.0, 0.0}, (struct vec3){0.0, 0.0, -1.0})));
}

static void lamp_is_dark_inside(void **state)
{
    assert_true(isinf(distance_from((struct vec3){1.0, 2.1, 3.2}, (struct vec3){0.0, 0.0, 1.0})));
    assert_near(sphere_light_solid_angle(&LAMP, (struct vec3){1.0, 2.1, 3.2}), 0.0, 0.0);
}

static void solid_angle_is_that_of_a_cone(void **state)
{
    // A half-angle of 30 degrees.
    assert_near(sphere_light_solid_angle(&LAMP, (struct vec3){1.0, 2.0, 2.0}), 2.0 * M_PI * (1.0 - sqrt(0.75)), 1e-14);
    // From afar it is the disc's: the next term is (r / d)^2 / 4 of it.
    assert_near(sphere_light_solid_angle(&LAMP, (struct vec3){1.0, 2.0, 1e9}) / (M_PI * 0.25e-18), 1.0, 1e-8);
    // At the surface it is half of all directions; at 2e-12 radii above it the cosine is 2e-6.
    assert_near(sphere_light_solid_angle(&LAMP, (struct vec3){1.0, 2.0, 2.5 - 1e-12}), 2.0 * M_PI, 1.3e-5);
}

static void drawn_directions_all_meet_the_lamp(void **state)
{
    struct random random = {21};

    for (int i = 0; i < 10000; i++) {
        double away = pow(10.0, random_between(&random, -4.0, 4.0));
        struct vec3 any = {random_between(&random, -1.0, 1.0), random_between(&random, -1.0, 1.0),
                           random_between(&random, -1.0, 1.0)};
        struct vec3 from = vec3_add(LAMP.center, vec3_scale(vec3_normalize(any), LAMP.radius + away));
        double u[] = {random_between(&random, 0.0, 0.9999), random_between(&random, 0.0, 1.0)};
        struct vec3 direction = sphere_light_draw(&LAMP, from, u);

        assert_near(vec3_length(direction), 1.0, 1e-14);
        assert_true(isfinite(distance_from(from, direction)));
    }
}

// A patch that faces a sphere at distance d along its normal sees the view factor (r / d)^2; turned by an angle while
// all of the sphere is above its horizon, (r / d)^2 cos. The integral of cosine over the lamp's solid angle is pi times
// that.
static void view_factor_is_the_closed_form(void **state)
{
    const int count = 400;
    struct vec3 from = {1.0, 2.0, 1.8};
    struct vec3 normal = {0.0, sin(0.7), cos(0.7)};
    double sum = 0.0;

    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++) {
            double u[] = {(i + 0.5) / count, (j + 0.5) / count};

            sum += vec3_dot(sphere_light_draw(&LAMP, from, u), normal) * sphere_light_solid_angle(&LAMP, from);
        }
    // 1e-6: the midpoint rule's error, which falls as 1 / count^2.
    assert_near(sum / count / count / M_PI, 0.25 / 1.44 * cos(0.7), 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ray_meets_the_near_side),        cmocka_unit_test(lamp_is_dark_inside),
        cmocka_unit_test(solid_angle_is_that_of_a_cone),  cmocka_unit_test(drawn_directions_all_meet_the_lamp),
        cmocka_unit_test(view_factor_is_the_closed_form),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
