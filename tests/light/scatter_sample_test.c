// Directions behind a scattering: the angle's cumulative probability is the share that it was drawn by.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include <cmocka.h>

enum { COUNT = 512 };

static float inputs[COUNT][4], outputs[COUNT][4];

static void probe(const char *const *modules, const char *body)
{
    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = COUNT,
                                                   .count = COUNT},
                     outputs);
}

// The probability of a cosine below 1 - less. Near the peak of a sharp lobe it is found from `less`, not from a cosine.
static double henyey_greenstein_below(double g, double less)
{
    double size = fabs(g), behind = g < 0 ? 2 - less : less;
    double distance = sqrt((1 - size) * (1 - size) + 2 * size * behind);
    double below = size > 0 ? (1 - size * size) / (2 * size) * (1 / distance - 1 / (1 + size)) : 1 - 0.5 * behind;

    return g < 0 ? 1 - below : below;
}

static void henyey_greenstein_is_drawn_by_its_integral(void **state)
{
    static const char *const MODULES[] = {"scatter/sample_henyey_greenstein.glsl", NULL};
    static const double SHARP[] = {0, 0.9, -0.9, 0.999, -0.99, 1e-4};
    struct random random = {5};

    (void)state;
    for (size_t i = 0; i < COUNT; ++i) {
        inputs[i][0] = (float)(i % 2 == 0 ? SHARP[i / 2 % 6] : random_between(&random, -0.95, 0.95));
        inputs[i][1] = (float)random_between(&random, 0, 1);
    }
    probe(MODULES, "vec4 probe(int i)\n{\n"
                   "    return vec4(scatter_henyey_greenstein(inputs[i].x, inputs[i].y), 0.0, 0.0, 0.0);\n}\n");
    for (size_t i = 0; i < COUNT; ++i) {
        double g = (double)inputs[i][0], share = (double)inputs[i][1], less = (double)outputs[i][0];
        double rounding = 1e-6 / (1 - fabs(g));

        // For backward lobes the share counts from the other end, and 1 - cos is rounded near 2, where the lobe is
        // steep.
        if (g < 0) rounding += 2e-7 / ((1 - fabs(g)) * (1 - fabs(g)));
        assert_true(less >= 0 && less <= 2);
        assert_true(fabs(henyey_greenstein_below(g, less) - (g < 0 ? 1 - share : share)) < rounding);
    }
}

static void rayleigh_is_drawn_by_its_integral(void **state)
{
    static const char *const MODULES[] = {"scatter/sample_rayleigh.glsl", NULL};

    (void)state;
    for (size_t i = 0; i < COUNT; ++i)
        inputs[i][0] = (float)i / COUNT;
    probe(MODULES, "vec4 probe(int i)\n{\n    return vec4(scatter_rayleigh(inputs[i].x), 0.0, 0.0, 0.0);\n}\n");
    for (size_t i = 0; i < COUNT; ++i) {
        double mu = 1 - (double)outputs[i][0];

        assert_true(fabs((mu * mu * mu + 3 * mu + 4) / 8 - (double)inputs[i][0]) < 1e-5);
    }
}

static double dot(const float *a, const float *b)
{
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

// Four turns by a quarter have the axis in their middle, and neighbours lie a right angle apart about it.
static void directions_turn_about_their_axis(void **state)
{
    static const char *const MODULES[] = {"scatter/turn.glsl", NULL};
    struct random random = {8};

    (void)state;
    for (size_t i = 0; i < COUNT; i += 4) {
        double z = i == 0 ? -1 : random_between(&random, -1, 1), angle = random_between(&random, 0, 7);
        double turn = random_between(&random, 0, 0.25);

        for (size_t k = 0; k < 4; ++k) {
            inputs[i + k][0] = (float)(sqrt(1 - z * z) * cos(angle));
            inputs[i + k][1] = (float)(sqrt(1 - z * z) * sin(angle));
            inputs[i + k][2] = (float)z;
            inputs[i + k][3] = (float)(turn + 0.25 * (double)k);
        }
    }
    probe(MODULES, "vec4 probe(int i)\n{\n    float less = float(i / 4) / 64.0;\n"
                   "    return vec4(scatter_turn(inputs[i].xyz, less, inputs[i].w), less);\n}\n");
    for (size_t i = 0; i < COUNT; i += 4) {
        for (size_t k = 0; k < 4; ++k) {
            double cosine = 1 - (double)outputs[i][3], sine = 1 - cosine * cosine;

            assert_true(fabs(dot(outputs[i + k], outputs[i + k]) - 1) < 1e-5);
            assert_true(fabs(dot(outputs[i + k], inputs[i]) - cosine) < 1e-5);
            assert_true(fabs(dot(outputs[i + k], outputs[i + (k + 1) % 4]) - cosine * cosine) < 2e-5);
            assert_true(fabs(dot(outputs[i + k], outputs[i + (k + 2) % 4]) - (cosine * cosine - sine)) < 2e-5);
        }
    }
}

// What a float cannot hold is there on the average: a thousand times a quarter of a last digit.
static void sums_lose_nothing(void **state)
{
    static const char *const MODULES[] = {"math/random.glsl", "scatter/sum.glsl", NULL};
    static const float SUMS[] = {0, 1, 16777216, 1e-3F, 5};
    static const double DIGITS[] = {0, 1.1920929e-7, 2, 1.1641532e-10, 4.7683716e-7}; // of these sums
    double mean[5] = {0};

    (void)state;
    for (size_t i = 0; i < COUNT; ++i) {
        inputs[i][0] = SUMS[i % 5];
        inputs[i][1] = i % 5 == 0 ? 0.1F : (float)(0.25 * DIGITS[i % 5]);
        inputs[i][2] = (float)i;
    }
    probe(MODULES, "vec4 probe(int i)\n{\n    float sum = inputs[i].x;\n    uint state = random_hash(uint(i));\n"
                   "    for (int k = 0; k < 1000; ++k) {\n        state = random_hash(state + 1u);\n"
                   "        sum = scatter_sum(sum, inputs[i].y, float(state >> 8u) / 16777216.0);\n    }\n"
                   "    vec3 all = scatter_sum(vec3(1.0), vec3(2.0, 3.0, 4.0), 0.5);\n"
                   "    return vec4(sum, all == vec3(3.0, 4.0, 5.0) ? 1.0 : 0.0, 0.0, 0.0);\n}\n");
    for (size_t i = 0; i < COUNT; ++i) {
        double more = ((double)outputs[i][0] - (double)inputs[i][0]) / (1000 * (double)inputs[i][1]);

        mean[i % 5] += more / (i % 5 < COUNT % 5 ? COUNT / 5 + 1 : COUNT / 5);
        assert_true(outputs[i][1] == 1.0F);
    }
    // A step of a digit in four has a standard deviation of 1.7 times its mean: 0.5 % of 102,000 steps.
    for (size_t i = 0; i < 5; ++i)
        assert_true(fabs(mean[i] - 1) < 0.025);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(henyey_greenstein_is_drawn_by_its_integral),
        cmocka_unit_test(rayleigh_is_drawn_by_its_integral),
        cmocka_unit_test(directions_turn_about_their_axis),
        cmocka_unit_test(sums_lose_nothing),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
