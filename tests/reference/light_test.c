// SPDX-License-Identifier: Apache-2.0
#include "reference/light.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct light SPOT = {.kind = SCENE_LIGHT_SPOT,
                                  .falloff = SCENE_FALLOFF_INVERSE_SQUARE,
                                  .intensity = {8.0, 4.0, 2.0},
                                  .position = {1.0, 2.0, 3.0},
                                  .direction = {0.0, 0.0, -1.0},
                                  .inner = 0.2,
                                  .outer = 0.6};

// `distance` m from the spot, at `angle` from its direction.
static struct light_arrival arrive(double distance, double angle)
{
    return light_arrive(&SPOT, (struct vec3){1.0 + distance * sin(angle), 2.0, 3.0 - distance * cos(angle)});
}

static void spot_is_a_point_in_its_inner_cone(void **state)
{
    for (int i = 0; i <= 10; i++) {
        struct light_arrival arrival = arrive(2.0, 0.0199 * i);

        assert_near(arrival.irradiance[0], 2.0, 1e-14);
        assert_near(arrival.irradiance[1], 1.0, 1e-14);
        assert_near(arrival.irradiance[2], 0.5, 1e-14);
        assert_near(arrival.distance, 2.0, 1e-14);
        assert_near(arrival.travel.x, sin(0.0199 * i), 1e-14);
        assert_near(arrival.travel.z, -cos(0.0199 * i), 1e-14);
    }
}

static void spot_fades_by_smoothstep_of_the_angle(void **state)
{
    // s^2 (3 - 2 s) at s = 1/4, 1/2, 3/4.
    assert_near(arrive(2.0, 0.5).irradiance[0], 2.0 * 0.15625, 1e-13);
    assert_near(arrive(2.0, 0.4).irradiance[0], 2.0 * 0.5, 1e-13);
    assert_near(arrive(2.0, 0.3).irradiance[0], 2.0 * 0.84375, 1e-13);
}

static void spot_is_dark_outside_of_its_outer_cone(void **state)
{
    for (int i = 0; i < 10; i++)
        assert_near(arrive(0.5, 0.601 + 0.25 * i).irradiance[0], 0.0, 0.0);
}

// The power of a spot whose cones are one: I times the cone's solid angle, on a plane across its axis.
static void spot_sends_its_power_through_a_plane(void **state)
{
    const int count = 20000;
    struct light spot = SPOT;
    double half = 0.5, power = 0.0, radius = tan(half);

    spot.inner = spot.outer = half;
    for (int i = 0; i < count; i++) {
        double r = radius * (i + 0.5) / count;
        struct light_arrival arrival = light_arrive(&spot, (struct vec3){1.0, 2.0 + r, 2.0});

        power += arrival.irradiance[0] * -arrival.travel.z * 2.0 * M_PI * r * radius / count;
    }
    // 1e-6: the midpoint rule's error on 20000 rings.
    assert_near(power, 8.0 * 2.0 * M_PI * (1.0 - cos(half)), 1e-6);
}

static void cones_that_are_one_have_a_sharp_edge(void **state)
{
    assert_near(light_spot_share(0.3, 0.3, 0.3), 1.0, 0.0);
    assert_near(light_spot_share(0.3, 0.3, 0.3 + 1e-12), 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spot_is_a_point_in_its_inner_cone),
        cmocka_unit_test(spot_fades_by_smoothstep_of_the_angle),
        cmocka_unit_test(spot_is_dark_outside_of_its_outer_cone),
        cmocka_unit_test(spot_sends_its_power_through_a_plane),
        cmocka_unit_test(cones_that_are_one_have_a_sharp_edge),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
