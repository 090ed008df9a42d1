// Boundaries of dielectrics: shader modules against formulas in double precision, on the same inputs rounded to float.
// SPDX-License-Identifier: Apache-2.0
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

// ROUNDING is half the relative distance between adjacent floats.
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

// eta is random in [0.1, 10]. Some values are 1 or a few roundings from it.
static double any_eta(struct random *random, size_t i)
{
    if (i % 16 == 0) return 1;
    if (i % 16 == 1) return 1 + random_between(random, -16, 16) * ROUNDING;
    return pow(10, random_between(random, -1, 1));
}

// Inputs: .x is the cosine of incidence, often grazing, .y is eta.
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

// Returns the error of refracted_square in floats: its two terms have some roundings each.
static double refracted_error(double cos_in, double eta)
{
    return 4 * ROUNDING * (fabs(1 - eta * eta) + eta * eta * cos_in * cos_in);
}

// Reflectance is one less transmittance. That follows from the transmitted amplitudes t of both polarisations and the
// energy n cos |t|^2 on each side. `square` is the refracted ray's cosine squared.
static double reflectance(double cos_in, double eta, double square)
{
    double cos_out = sqrt(fmax(square, 0));
    double across = 2 * eta * cos_in / (eta * cos_in + cos_out);
    double along = 2 * eta * cos_in / (cos_in + eta * cos_out);

    if (square <= 0) return 1;
    return 1 - 0.5 * (across * across + along * along) * cos_out / (eta * cos_in);
}

// Returns the error of the reflectance in floats: that of the square, and a dozen roundings.
static double reflectance_error(double cos_in, double eta)
{
    double square = refracted_square(cos_in, eta), doubt = refracted_error(cos_in, eta);
    double share = reflectance(cos_in, eta, square);
    double more = reflectance(cos_in, eta, square + doubt), less = reflectance(cos_in, eta, square - doubt);

    return 16 * ROUNDING + fmax(fabs(more - share), fabs(less - share));
}

static void assert_energy_is_kept(bool on_egl)
{
    put_boundaries();
    probe("vec4 probe(int i)\n{\n    return vec4(fresnel_exact(inputs[i].x, inputs[i].y));\n}\n", on_egl);
    for (size_t i = 0; i < COUNT; ++i) {
        double cos_in = inputs[i][0], eta = inputs[i][1];

        if (inputs[i][1] == 1.0f) assert_true(outputs[i][0] == 0.0f);
        assert_near(outputs[i][0], reflectance(cos_in, eta, refracted_square(cos_in, eta)),
                    reflectance_error(cos_in, eta));
    }
}

static void energy_is_conserved(void **state)
{
    assert_energy_is_kept(false);
    assert_energy_is_kept(true);
}

// Reflectance is the same from both sides of a boundary. They differ by the rounding of the cosine.
static void both_sides_of_a_boundary_reflect_alike(void **state)
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
        // The squares have some roundings, which a small root magnifies. Reflectance changes at most 5 times as fast.
        double tolerance = 64 * ROUNDING * (eta * eta + 1 / (eta * eta)) / least;

        if (least < 0.05) continue;
        ++seen;
        assert_near(outputs[i][0], 0, tolerance);
        assert_near(outputs[i][1], 0, tolerance);
    }
    assert_true(seen > COUNT / 4);
}

static void at_normal_incidence_the_iors_alone_count(void **state)
{
    put_boundaries();
    probe("vec4 probe(int i)\n{\n    return vec4(fresnel_exact(1.0, inputs[i].y), snell_cos(1.0, inputs[i].y),\n"
          "                fresnel_schlick(FresnelSchlick(0.25, 1.0), 1.0, inputs[i].y),\n"
          "                fresnel_none(1.0, inputs[i].y));\n}\n",
          false);
    for (size_t i = 0; i < COUNT; ++i) {
        double eta = inputs[i][1], ratio = (1 - eta) / (1 + eta);

        // The cosine is the root of 1 - eta^2 + eta^2, with roundings of up to 100.
        assert_near(outputs[i][0], ratio * ratio, 8 * ROUNDING * (1 + eta * eta));
        assert_near(outputs[i][1], 1, 4 * ROUNDING * (1 + eta * eta));
        assert_near(outputs[i][2], 0.25, 4 * ROUNDING);
        assert_true(outputs[i][3] == 0.0f);
    }
}

// Reflected and refracted ray are at right angles at Brewster's angle, tan = 1 / eta. Only light polarised across the
// plane of incidence is reflected.
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
        double slope = reflectance(nearby, eta, refracted_square(nearby, eta)) -
                       reflectance(cos_in, eta, refracted_square(cos_in, eta));

        assert_near(outputs[i][0], 0.5 * across * across, reflectance_error(cos_in, eta) + 2 * fabs(slope));
    }
}

// Schlick's formula takes the cosine on the side of the lower index of refraction. Its square has some roundings, which
// the root magnifies.
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
        double square = refracted_square(cos_in, eta), doubt = refracted_error(cos_in, eta);
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

// Angles are a thousandth of a radian on either side of the critical angle, for every kind of Fresnel formula.
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

// Reflectances stay in [0, 1] and directions stay unit vectors for every pair of the worst cosines and etas.
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
          "    vec3 incoming = vec3(sqrt(max(1.0 - c * c, 0.0)), -c, 0.0);\n"
          "    return vec4(shares, length(snell_refract(incoming, vec3(0.0, 1.0, 0.0), c, after, eta)));\n}\n",
          false);
    for (size_t i = 0; i < COUNT; ++i) {
        for (int c = 0; c < 3; ++c)
            assert_true(outputs[i][c] >= 0 && outputs[i][c] <= 1);
        assert_near(outputs[i][3], 1, 4 * ROUNDING);
        // All light along the surface is reflected, and none where eta = 1 makes no boundary.
        if (inputs[i][0] <= 0) assert_near(outputs[i][0], inputs[i][1] == 1.0f ? 0 : 1, 2e-6);
    }
}

static void assert_snells_law(bool on_egl)
{
    struct random random = {31};
    size_t seen = 0;

    for (size_t i = 0; i < COUNT; ++i) {
        struct vec3 normal = probe_any_direction(&random), direction = probe_any_direction(&random);

        probe_put_vector(inputs[2 * i], normal);
        probe_put_vector(inputs[2 * i + 1], vec3_dot(direction, normal) < 0 ? direction : vec3_scale(direction, -1));
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
        cmocka_unit_test(energy_is_conserved),
        cmocka_unit_test(both_sides_of_a_boundary_reflect_alike),
        cmocka_unit_test(at_normal_incidence_the_iors_alone_count),
        cmocka_unit_test(brewsters_angle_loses_one_polarisation),
        cmocka_unit_test(schlick_is_a_power_on_the_thin_side),
        cmocka_unit_test(beyond_the_critical_angle_all_is_reflected),
        cmocka_unit_test(the_worst_boundaries_stay_finite),
        cmocka_unit_test(rays_bend_by_snells_law),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
