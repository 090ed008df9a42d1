// SPDX-License-Identifier: Apache-2.0
#include "reference/light_walk.h"

#include "tests/support/assert_near.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct ray UPWARDS = {{0.1, 0.0, -4.0}, {0.0, 0.0, 1.0}};

static double walk(const struct still *still, const struct ray *ray, double distance)
{
    double share[3];

    light_walk(still, ray, distance, &(struct transmittance_accuracy){.optical_depth = 1e-9}, share);
    return share[1];
}

// Fresnel reflectance of unpolarised light that enters glass at an angle.
static double reflected(double angle, double ior)
{
    double cos_in = cos(angle), cos_out = sqrt(1.0 - sin(angle) * sin(angle) / (ior * ior));
    double across = (cos_in - ior * cos_out) / (cos_in + ior * cos_out);
    double along = (ior * cos_in - cos_out) / (ior * cos_in + cos_out);

    return 0.5 * (across * across + along * along);
}

static void a_plate_reflects_and_absorbs(void **state)
{
    const struct shape plate = solid_box((struct vec3){0.0, 0.0, 0.0}, (struct vec3){40.0, 40.0, 0.25});
    const struct material glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5);

    for (int i = 0; i < 7; i++) {
        double angle = 0.2 * i, passed = 1.0 - reflected(angle, 1.5), length = 0.5 / cos(angle);
        struct ray ray = {{0.0, 0.0, -4.0}, {sin(angle), 0.0, cos(angle)}};
        struct still still;

        solid_still_init(&still);
        solid_still_add(&still, &glass, &plate, 1);
        solid_still_fill(&still, 1, 0.5, 0.25);
        assert_near(walk(&still, &ray, INFINITY), passed * passed * exp(-0.75 * length), 1e-12);
        // The same holds for a light inside the plate, and for a ray from inside.
        assert_near(walk(&still, &ray, 4.0 / cos(angle)), passed * exp(-0.75 * 0.5 * length), 1e-12);
        ray.origin.z = 0.0;
        assert_near(walk(&still, &ray, INFINITY), passed * exp(-0.75 * 0.5 * length), 1e-12);
        // Light is taken to come from the thinner side, so that nothing is totally reflected in a gap between plates
        // either.
        still.objects.list[0].material.ior = 1.0 / 1.5;
        passed = 1.0 - reflected(angle, 1.5);
        assert_near(walk(&still, &ray, INFINITY), passed * exp(-0.75 * 0.5 * length), 1e-12);
    }
}

static void opaque_solids_hide_the_light(void **state)
{
    const struct shape balls[] = {solid_sphere(0.0, 0.0, 0.0, 1.0), solid_sphere(3.0, 0.0, 0.0, 1.0)};
    const struct material opaque[] = {solid_mirror(1.0), solid_diffuse(1.0)};

    for (int i = 0; i < 2; i++) {
        struct ray aside = UPWARDS;
        struct still still;

        solid_still_init(&still);
        solid_still_add(&still, &opaque[i], balls, 2);
        assert_near(walk(&still, &UPWARDS, INFINITY), 0.0, 0.0);
        assert_near(walk(&still, &UPWARDS, 3.1), 0.0, 0.0);
        assert_near(walk(&still, &UPWARDS, 2.9), 1.0, 0.0);
        aside.origin.x = 1.1;
        assert_near(walk(&still, &aside, INFINITY), 1.0, 0.0);
        aside.origin.x = 2.9;
        assert_near(walk(&still, &aside, INFINITY), 0.0, 0.0);
    }
}

static void boundaries_between_equals_reflect_nothing(void **state)
{
    const struct shape parts[] = {solid_box((struct vec3){0.0, 0.0, -0.5}, (struct vec3){1.0, 1.0, 0.5}),
                                  solid_box((struct vec3){0.0, 0.0, 0.25}, (struct vec3){1.0, 1.0, 0.75})};
    const struct material glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5), dense = solid_glass(SCENE_FRESNEL_EXACT, 2.0);
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &glass, parts, 2);
    solid_still_fill(&still, 1, 0.0, 0.3);
    assert_near(walk(&still, &UPWARDS, INFINITY), 0.96 * 0.96 * exp(-0.6), 1e-12);
    // Both objects are of the same glass.
    solid_still_init(&still);
    solid_still_add(&still, &glass, &parts[0], 1);
    solid_still_add(&still, &glass, &parts[1], 1);
    assert_near(walk(&still, &UPWARDS, INFINITY), 0.96 * 0.96, 1e-12);
    // The glasses differ: the later one's boundary lies in the earlier one.
    still.objects.list[1].material = dense;
    solid_still_fill(&still, 1, 0.0, 0.3);
    solid_still_fill(&still, 2, 0.0, 0.7);
    assert_near(walk(&still, &UPWARDS, INFINITY),
                0.96 * (1.0 - 0.25 / 12.25) * (1.0 - 1.0 / 9.0) * exp(-0.3 * 0.5 - 0.7 * 1.5), 1e-12);
}

static void the_air_ends_where_objects_are(void **state)
{
    const struct shape ball = solid_sphere(0.1, 0.0, 0.0, 1.0);
    const struct material glass = solid_glass(SCENE_FRESNEL_NONE, 1.5);
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &glass, &ball, 1);
    solid_still_fill(&still, 0, 0.1, 0.1);
    assert_near(walk(&still, &UPWARDS, 7.0), exp(-0.2 * 5.0), 1e-12);
    assert_near(walk(&still, &UPWARDS, INFINITY), 0.0, 0.0);
}

static void schlick_counts_for_light_as_well(void **state)
{
    const struct shape plate = solid_box((struct vec3){0.0, 0.0, 0.0}, (struct vec3){40.0, 40.0, 0.25});
    struct material glass = solid_glass(SCENE_FRESNEL_SCHLICK, 1.5);
    const struct ray slanted = {{0.0, 0.0, -4.0}, {sqrt(0.75), 0.0, 0.5}};
    struct still still;

    glass.fresnel.has_f0 = true;
    glass.fresnel.f0 = 0.3;
    glass.fresnel.f90 = 0.8;
    solid_still_init(&still);
    solid_still_add(&still, &glass, &plate, 1);
    assert_near(walk(&still, &slanted, INFINITY), pow(1.0 - 0.3 - 0.5 / 32.0, 2.0), 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plate_reflects_and_absorbs),
        cmocka_unit_test(opaque_solids_hide_the_light),
        cmocka_unit_test(boundaries_between_equals_reflect_nothing),
        cmocka_unit_test(the_air_ends_where_objects_are),
        cmocka_unit_test(schlick_counts_for_light_as_well),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
