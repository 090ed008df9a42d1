// Boundaries of dielectrics: the shaders' modules against formulas in double precision.
// SPDX-License-Identifier: Apache-2.0
// Both get the same inputs, rounded to float.
#include "reference/vec3.h"
#include "tests/support/assert_near.h"
#include "tests/support/probe_vectors.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { COUNT = 512 };

// Half the distance from one float to the next, relative.
static const double ROUNDING = 0x1p-24;

static const char *const modules[] = {"surface/snell.glsl", "surface/fresnel_exact.glsl",
                                      "surface/fresnel_schlick.glsl", "surface/fresnel_none.glsl", NULL};

static float inputs[SHADER_PROBE_INPUT_LIMIT][4];
static float outputs[COUNT][4];

static void probe(const char *body, bool on_egl)
{
    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = SHADER_PROBE_INPUT_LIMIT,
                                                   .count = COUNT,
                                                   .on_egl = on_egl},
                     outputs);
}

// eta anywhere in [0.1, 10], some of them 1 or a few roundings from it.
static double any_eta(struct random *random, size_t i)
{
    if (i % 16 == 0) return 1;
    if (i % 16 == 1) return 1 + random_between(random, -16, 16) * ROUNDING;
    return pow(10, random_between(random, -1, 1));
}

// Cosines in .x and etas in .y, many of them grazing.
static void put_boundaries(void)
{
    struct random random = {17};

    for (size_t i = 0; i < COUNT; ++i) {
        double part = random_between(&random, 0, 1);

        inputs[i][0] = (float)(i % 4 == 0 ? pow(10, -6 * part) : part);
        inputs[i][1] = (float)any_eta(&random, i);
    }
}

// The square of the refracted ray's cosine.
static double refracted_square(double cos_in, double eta)
{
    return 1 - eta * eta * (1 - cos_in * cos_in);
}

// Returns the uncertainty in floats: the two terms have some roundings each.
static double refracted_doubt(double cos_in, double eta)
{
    return 4 * ROUNDING * (fabs(1 - eta * eta) + eta * eta * cos_in * cos_in);
}

// One less the energy that gets through, by the transmitted amplitudes of both polarisations and the energy n cos |t|^2
// on each side. `square` is the refracted ray's cosine squared.
static double reflected_share(double cos_in, double eta, double square)
{
    double cos_out = sqrt(fmax(square, 0));
    double across = 2 * eta * cos_in / (eta * cos_in + cos_out);
    double along = 2 * eta * cos_in / (cos_in + eta * cos_out);

    if (square <= 0) return 1;
    return 1 - 0.5 * (across * across + along * along) * cos_out / (eta * cos_in);
}

// How far the share may be off for what is unknown of the square, and a dozen roundings.
static double share_doubt(double cos_in, double eta)
{
    double square = refracted_square(cos_in, eta), doubt = refracted_doubt(cos_in, eta);
    double share = reflected_share(cos_in, eta, square);
    double more = reflected_share(cos_in, eta, square + doubt), less = reflected_share(cos_in, eta, square - doubt);

    return 16 * ROUNDING + fmax(fabs(more - share), fabs(less - share));
}

static void assert_energy_is_kept(bool on_egl)
{
    put_boundaries();
    probe("vec4 probe(int i)\n{\n    return vec4(fresnel_exact(inputs[i].x, inputs[i].y));\n}\n", on_egl);
    for (size_t i = 0; i < COUNT; ++i) {
        double cos_in = inputs[i][0], eta = inputs[i][1];

        if (inputs[i][1] == 1.0f) assert_true(outputs[i][0] == 0.0f);
        assert_near(outputs[i][0], reflected_share(cos_in, eta, refracted_square(cos_in, eta)),
                    share_doubt(cos_in, eta));
    }
}

static void what_is_not_reflected_gets_through(void **state)
{
    assert_energy_is_kept(false);
    assert_energy_is_kept(true);
}

// Beside the critical angle all of the difference is the cosine's rounding.
static void both_ways_through_a_boundary_are_alike(void **state)
{
    size_t seen = 0;

    put_boundaries();
    probe("vec4 probe(int i)\n{\n    float after = snell_cos(inputs[i].x, inputs[i].y);\n"
          "    FresnelSchlick schlick = FresnelSchlick(0.04, 0.9);\n"
          "    return vec4(fresnel_exact(inputs[i].x, inputs[i].y) - fresnel_exact(after, 1.0 / inputs[i].y),\n"
          "                fresnel_schlick(schlick, inputs[i].x, inputs[i].y)\n"
          "                - fresnel_schlick(schlick, after, 1.0 / inputs[i].y), after, 0.0);\n}\n",
          false);
    for (size_t i = 0; i < COUNT; ++i) {
        double eta = inputs[i][1], least = fmin(inputs[i][0], outputs[i][2]);
        // Some roundings of the squares, which a root makes more the smaller it is; shares change at most 5 times as fast.
        double tolerance = 64 * ROUNDING * (eta * eta + 1 / (eta * eta)) / least;

        if (least < 0.05) continue;
        ++seen;
        assert_near(outputs[i][0], 0, tolerance);
        assert_near(outputs[i][1], 0, tolerance);
    }
    assert_true(seen > COUNT / 4);
}

static void at_right_angles_the_iors_alone_count(void **state)
{
    put_boundaries();
    probe("vec4 probe(int i)\n{\n    return vec4(fresnel_exact(1.0, inputs[i].y), snell_cos(1.0, inputs[i].y),\n"
          "                fresnel_schlick(FresnelSchlick(0.25, 1.0), 1.0, inputs[i].y),\n"
          "                fresnel_none(1.0, inputs[i].y));\n}\n",
          false);
    for (size_t i = 0; i < COUNT; ++i) {
        double eta = inputs[i][1], ratio = (1 - eta) / (1 + eta);

        // 1 - eta^2 + eta^2: roundings of 100.
        assert_near(outputs[i][0], ratio * ratio, 8 * ROUNDING * (1 + eta * eta));
        assert_near(outputs[i][1], 1, 4 * ROUNDING * (1 + eta * eta));
        assert_near(outputs[i][2], 0.25, 4 * ROUNDING);
        assert_true(outputs[i][3] == 0.0f);
    }
}

// Where reflected and refracted ray are at right angles, tan = 1 / eta, only light across the plane is reflected.
static void brewsters_angle_loses_one_polarisation(void **state)
{
    struct random random = {23};

    for (size_t i = 0; i < COUNT; ++i) {
        double eta = pow(10, random_between(&random, -1, 1));

        inputs[i][1] = (float)eta;
        inputs[i][0] = (float)cos(atan(1 / eta));
    }
    probe("vec4 probe(int i)\n{\n    return vec4(fresnel_exact(inputs[i].x, inputs[i].y));\n}\n", false);
    for (size_t i = 0; i < COUNT; ++i) {
        double cos_in = inputs[i][0], eta = inputs[i][1], across = (1 - eta * eta) / (1 + eta * eta);
        double nearby = cos_in * (1 - ROUNDING);
        double slope = reflected_share(nearby, eta, refracted_square(nearby, eta)) -
                       reflected_share(cos_in, eta, refracted_square(cos_in, eta));

        assert_near(outputs[i][0], 0.5 * across * across, share_doubt(cos_in, eta) + 2 * fabs(slope));
    }
}

// c = cosine on the side of the smaller ior; its square is known to some roundings, which a root makes many.
static void schlick_is_a_power_on_the_thin_side(void **state)
{
    put_boundaries();
    for (size_t i = 0; i < COUNT; ++i) {
        inputs[i][2] = 0.01f * (float)(i % 50);
        inputs[i][3] = i % 3 == 0 ? 1.0f : 0.6f;
    }
    probe("vec4 probe(int i)\n{\n"
          "    return vec4(fresnel_schlick(FresnelSchlick(inputs[i].z, inputs[i].w), inputs[i].x, inputs[i].y));\n}\n",
          false);
    for (size_t i = 0; i < COUNT; ++i) {
        double cos_in = inputs[i][0], eta = inputs[i][1], f0 = inputs[i][2], f90 = inputs[i][3];
        double square = refracted_square(cos_in, eta), doubt = refracted_doubt(cos_in, eta);
        double thin = eta > 1 ? sqrt(fmax(square, 0)) : cos_in;
        double thin_doubt = eta > 1 ? sqrt(fmax(square, 0) + doubt) - thin : 0;
        double wanted = f0 + (f90 - f0) * pow(1 - thin, 5);

        if (eta > 1 && fabs(square) <= doubt) continue;
        if (square < 0)
            assert_true(outputs[i][0] == 1.0f);
        else
            assert_near(outputs[i][0], wanted, 10 * thin_doubt + 16 * ROUNDING);
    }
}

// A thousandth of a radian on either side of it, whatever the kind.
static void beyond_the_critical_angle_all_is_reflected(void **state)
{
    struct random random = {29};

    for (size_t i = 0; i < COUNT; ++i) {
        double eta = 1.01 + pow(10, random_between(&random, -2, 0.95));

        inputs[i][1] = (float)eta;
        inputs[i][0] = (float)cos(asin(1 / eta) + (i % 2 == 0 ? 1e-3 : -1e-3));
    }
    probe("vec4 probe(int i)\n{\n    return vec4(snell_cos(inputs[i].x, inputs[i].y),\n"
          "                fresnel_exact(inputs[i].x, inputs[i].y),\n"
          "                fresnel_schlick(FresnelSchlick(0.0, 0.5), inputs[i].x, inputs[i].y),\n"
          "                fresnel_none(inputs[i].x, inputs[i].y));\n}\n",
          false);
    for (size_t i = 0; i < COUNT; ++i) {
        bool is_beyond = i % 2 == 0;

        assert_true((outputs[i][0] < 0) == is_beyond);
        for (int c = 1; c < 4; ++c)
            assert_true((outputs[i][c] == 1.0f) == is_beyond);
    }
}

// Every pair of the worst cosines and etas: shares stay shares, directions stay directions.
static void the_worst_boundaries_stay_finite(void **state)
{
    static const float cosines[] = {-1e-6f, -1e-30f,    0, 1e-38f,     1e-20f, 1e-8f,
                                    1e-4f,  0.9999999f, 1, 1.0000001f, 1.0001f};
    static const float etas[] = {0.01f, 0.1f, 0.5f, 0.99999994f, 1, 1.0000001f, 1.5f, 10, 100};
    enum { COSINES = sizeof cosines / sizeof cosines[0], ETAS = sizeof etas / sizeof etas[0] };

    memset(inputs, 0, sizeof inputs);
    for (size_t i = 0; i < COUNT; ++i) {
        inputs[i][0] = cosines[i % COSINES];
        inputs[i][1] = etas[i / COSINES % ETAS];
    }
    probe("vec4 probe(int i)\n{\n    float c = inputs[i].x;\n    float eta = inputs[i].y;\n"
          "    vec3 shares = vec3(fresnel_exact(c, eta), fresnel_schlick(FresnelSchlick(0.0, 1.0), c, eta),\n"
          "                       fresnel_none(c, eta));\n"
          "    float after = max(snell_cos(c, eta), 0.0);\n"
          "    vec3 way = vec3(sqrt(max(1.0 - c * c, 0.0)), -c, 0.0);\n"
          "    return vec4(shares, length(snell_refract(way, vec3(0.0, 1.0, 0.0), c, after, eta)));\n}\n",
          false);
    for (size_t i = 0; i < COUNT; ++i) {
        for (int c = 0; c < 3; ++c)
            assert_true(outputs[i][c] >= 0 && outputs[i][c] <= 1);
        assert_near(outputs[i][3], 1, 4 * ROUNDING);
        // Along the surface all is reflected, but where there is none.
        if (inputs[i][0] <= 0) assert_near(outputs[i][0], inputs[i][1] == 1.0f ? 0 : 1, 2e-6);
    }
}

static void assert_snells_law(bool on_egl)
{
    struct random random = {31};
    size_t seen = 0;

    for (size_t i = 0; i < COUNT; ++i) {
        struct vec3 normal = probe_any_direction(&random), way = probe_any_direction(&random);

        probe_put_vector(inputs[2 * i], normal);
        probe_put_vector(inputs[2 * i + 1], vec3_dot(way, normal) < 0 ? way : vec3_scale(way, -1));
        inputs[2 * i][3] = (float)any_eta(&random, i);
    }
    probe("vec4 probe(int i)\n{\n    vec3 n = inputs[2 * i].xyz;\n    vec3 d = inputs[2 * i + 1].xyz;\n"
          "    float cos_in = -dot(d, n);\n    float cos_out = snell_cos(cos_in, inputs[2 * i].w);\n"
          "    return vec4(cos_out < 0.0 ? vec3(0.0) : snell_refract(d, n, cos_in, cos_out, inputs[2 * i].w), cos_out);"
          "\n}\n",
          on_egl);
    for (size_t i = 0; i < COUNT; ++i) {
        struct vec3 n = probe_vector(inputs[2 * i]), d = probe_vector(inputs[2 * i + 1]), t = probe_vector(outputs[i]);
        double eta = inputs[2 * i][3], sin_in = vec3_length(vec3_cross(d, n)), tolerance = 8 * ROUNDING * (1 + eta);

        if (outputs[i][3] < 0) {
            assert_true(eta * sin_in > 1 - 1e-5);
            continue;
        }
        ++seen;
        assert_near(vec3_length(t), 1, 4 * ROUNDING);
        assert_near(vec3_length(vec3_cross(t, n)), eta * sin_in, tolerance);
        // Both rays and the normal are in one plane, on both sides of the normal.
        assert_near(vec3_dot(t, vec3_cross(d, n)), 0, tolerance);
        assert_true(vec3_dot(vec3_cross(t, n), vec3_cross(d, n)) > -tolerance);
        assert_true(vec3_dot(t, n) < tolerance);
        if (eta == 1)
            for (int c = 0; c < 3; ++c)
                assert_near(outputs[i][c], inputs[2 * i + 1][c], 8 * ROUNDING);
    }
    assert_true(seen > COUNT / 2);
}

static void rays_bend_by_snells_law(void **state)
{
    assert_snells_law(false);
    assert_snells_law(true);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_not_reflected_gets_through),
        cmocka_unit_test(both_ways_through_a_boundary_are_alike),
        cmocka_unit_test(at_right_angles_the_iors_alone_count),
        cmocka_unit_test(brewsters_angle_loses_one_polarisation),
        cmocka_unit_test(schlick_is_a_power_on_the_thin_side),
        cmocka_unit_test(beyond_the_critical_angle_all_is_reflected),
        cmocka_unit_test(the_worst_boundaries_stay_finite),
        cmocka_unit_test(rays_bend_by_snells_law),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
