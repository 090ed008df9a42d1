// SPDX-License-Identifier: Apache-2.0
#include "reference/fresnel.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double ETAS[] = {1.0 / 10.0, 1.0 / 1.5, 1.0 / 1.33, 0.999, 1.0, 1.001, 1.33, 1.5, 10.0};
enum { ETA_COUNT = sizeof ETAS / sizeof ETAS[0], ANGLES = 200 };

static void normal_incidence_is_as_known(void **state)
{
    for (int i = 0; i < ETA_COUNT; i++) {
        double wanted = (ETAS[i] - 1.0) / (ETAS[i] + 1.0);

        assert_near(fresnel_exact(1.0, ETAS[i]), wanted * wanted, 1e-15);
    }
    assert_near(fresnel_exact(1.0, 1.0 / 1.5), 0.04, 1e-15);
}

// Light polarised along the plane of incidence is not reflected at all at Brewster's angle, tan theta = 1 / eta.
static void brewster_reflects_one_polarisation(void **state)
{
    for (int i = 0; i < ETA_COUNT; i++) {
        double eta = ETAS[i], square = eta * eta, cosine = eta / sqrt(1.0 + square);
        double across = (1.0 - square) / (1.0 + square);

        assert_near(fresnel_exact(cosine, eta), 0.5 * across * across, 1e-14);
    }
}

static void grazing_light_is_reflected(void **state)
{
    for (int i = 0; i < ETA_COUNT; i++) {
        if (ETAS[i] != 1.0) assert_near(fresnel_exact(0.0, ETAS[i]), 1.0, 0.0);
        assert_near(fresnel_schlick(0.04, 1.0, 0.0, ETAS[i]), 1.0, 0.0);
    }
    assert_near(fresnel_exact(0.0, 1.0), 0.0, 0.0);
    assert_near(fresnel_schlick(0.04, 0.7, 0.0, 1.0 / 1.5), 0.7, 0.0);
}

static void all_is_reflected_beyond_the_critical_angle(void **state)
{
    static const struct fresnel KINDS[] = {
        {.kind = SCENE_FRESNEL_EXACT}, {.kind = SCENE_FRESNEL_SCHLICK, .f90 = 0.5}, {.kind = SCENE_FRESNEL_NONE}};

    for (int i = 0; i < ETA_COUNT; i++) {
        double eta = ETAS[i], critical = eta > 1.0 ? sqrt(1.0 - 1.0 / (eta * eta)) : 0.0;

        for (int k = 0; k < 3 && eta > 1.0; k++) {
            assert_near(fresnel_share(&KINDS[k], critical - 1e-9, eta, 1.0), 1.0, 0.0);
            assert_true(fresnel_share(&KINDS[k], critical + 1e-6, eta, 1.0) < 1.0);
        }
        assert_true(eta > 1.0 ? fresnel_cos_out(critical - 1e-9, eta) < 0.0 : fresnel_cos_out(0.0, eta) >= 0.0);
    }
}

// The same share is reflected in the opposite direction along the same path.
static void both_directions_reflect_alike(void **state)
{
    const struct fresnel kinds[] = {{.kind = SCENE_FRESNEL_EXACT},
                                    {.kind = SCENE_FRESNEL_SCHLICK, .f90 = 1.0},
                                    {.kind = SCENE_FRESNEL_SCHLICK, .f0 = 0.2, .f90 = 0.6, .has_f0 = true},
                                    {.kind = SCENE_FRESNEL_NONE}};

    for (int i = 0; i < ETA_COUNT * ANGLES; i++) {
        double eta = ETAS[i / ANGLES], cosine = (i % ANGLES + 0.5) / ANGLES;
        double cos_out = fresnel_cos_out(cosine, eta);

        for (int k = 0; k < 4 && cos_out >= 0.0; k++) {
            double there = fresnel_share(&kinds[k], cosine, eta, 1.0),
                   back = fresnel_share(&kinds[k], cos_out, 1.0, eta);

            assert_near(there, back, 1e-9); // a root near the critical angle
            assert_true(there >= 0.0 && there <= 1.0);
        }
    }
}

static void schlick_follows_its_formula(void **state)
{
    const struct fresnel given = {.kind = SCENE_FRESNEL_SCHLICK, .f0 = 0.2, .f90 = 0.9, .has_f0 = true};
    const struct fresnel free = {.kind = SCENE_FRESNEL_SCHLICK, .f0 = 0.2, .f90 = 1.0};

    assert_near(fresnel_share(&given, 0.5, 1.0, 1.5), 0.2 + 0.7 / 32.0, 1e-15);
    assert_near(fresnel_share(&free, 1.0, 1.0, 1.5), 0.04, 1e-15);
    assert_near(fresnel_share(&free, 0.5, 1.0, 1.5), 0.04 + 0.96 / 32.0, 1e-15);
    // The cosine is that of the thinner side where light leaves the denser one.
    assert_near(fresnel_share(&free, sqrt(1.0 - 0.75 / 2.25), 1.5, 1.0), 0.04 + 0.96 / 32.0, 1e-12);
}

static void refraction_obeys_snell(void **state)
{
    const struct vec3 normal = {0.0, 0.6, -0.8}, side = {0.0, 0.8, 0.6};

    for (int i = 0; i < ETA_COUNT * ANGLES; i++) {
        double eta = ETAS[i / ANGLES], cosine = (i % ANGLES + 0.5) / ANGLES, sine = sqrt(1.0 - cosine * cosine);
        struct vec3 in = vec3_subtract(vec3_scale(side, sine), vec3_scale(normal, cosine)), out;
        double cos_out = fresnel_cos_out(cosine, eta);

        if (cos_out < 0.0) continue;
        out = fresnel_refract(in, normal, eta);
        assert_near(vec3_length(out), 1.0, 1e-14);
        assert_near(vec3_dot(out, side), eta * sine, 1e-12);
        assert_near(vec3_dot(out, normal), -cos_out, 1e-7); // a root near the critical angle
        out = fresnel_reflect(in, normal);
        assert_near(vec3_dot(out, side), sine, 1e-14);
        assert_near(vec3_dot(out, normal), cosine, 1e-14);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normal_incidence_is_as_known),  cmocka_unit_test(brewster_reflects_one_polarisation),
        cmocka_unit_test(grazing_light_is_reflected),    cmocka_unit_test(all_is_reflected_beyond_the_critical_angle),
        cmocka_unit_test(both_directions_reflect_alike), cmocka_unit_test(schlick_follows_its_formula),
        cmocka_unit_test(refraction_obeys_snell),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
