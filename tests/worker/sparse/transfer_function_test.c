// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/transfer_function.h"

#include "reference/transfer_function.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { COUNT = 512, POINTS = 7 };

// The opacity rises, falls to 0, stays 0, steps up and is nearly 1; the values differ in float and double.
static const struct scene_transfer_point points[POINTS] = {
    {-10.1, {0.1, 0.2, 0.3, 0}},  {0.3, {1, 0, 0.7, 1e-5}},  {20.7, {0.3, 5, 0, 0.6}},  {40.9, {0, 0, 0, 0}},
    {60.2, {0.9, 0.1, 0.1, 0.0}}, {60.21, {2, 1, 3, 0.999}}, {90, {0, 1, 2, 1 - 1e-6}},
};

static float inputs[COUNT][4], outputs[COUNT][4];

static void probe(void)
{
    static const char *const modules[] = {"transfer/piecewise.glsl", NULL};
    char *body = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&body, &length);

    transfer_function_write(out, "seen", points, POINTS);
    fputs("vec4 probe(int i)\n{\n    float value = inputs[i].x;\n"
          "    return vec4(seen_rgb(value), transfer_extinction(seen_opacity(value), 0.25));\n}\n",
          out);
    fclose(out);
    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = COUNT,
                                                   .count = COUNT},
                     outputs);
    free(body);
}

static void shader_is_its_twin(void **state)
{
    const struct transfer_function twin = {.points = points, .count = POINTS, .unit_distance = 0.25};
    struct random random = {31};

    for (size_t i = 0; i < COUNT; i++)
        inputs[i][0] = (float)random_between(&random, i % 4 ? -20 : 60.1, i % 4 ? 100 : 60.3);
    probe();
    for (size_t i = 0; i < COUNT; i++) {
        double value = inputs[i][0], extinction = transfer_function_extinction(&twin, value), rgb[3];
        // Points are rounded to float, 2e-6 at 60, and the steepest step is 0.01 wide: 4e-4 of its height there.
        // Elsewhere a few roundings of a color; those of an opacity by as much as it lacks to 1.
        bool is_steep = fabs(value - 60.2) < 0.1;
        double share = is_steep ? 1e-3 : 4e-6;

        transfer_function_color(&twin, value, rgb);
        for (int c = 0; c < 3; c++)
            assert_near((double)outputs[i][c], rgb[c], 5 * share);
        assert_near((double)outputs[i][3], extinction, 4 * share * exp(0.25 * extinction) + 1e-6 * extinction);
    }
}

// -ln(1 - a) is exact to a float's precision for the smallest opacities, where 1 - a would be 1.
static void faint_opacity_keeps_its_digits(void **state)
{
    static const char *const modules[] = {"transfer/piecewise.glsl", NULL};

    for (size_t i = 0; i < COUNT; i++)
        inputs[i][0] = (float)pow(10, -30.0 * (double)(COUNT - i) / COUNT);
    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body =
                                                       "vec4 probe(int i)\n{\n"
                                                       "    return vec4(transfer_extinction(inputs[i].x, 1.0));\n}\n",
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = COUNT,
                                                   .count = COUNT},
                     outputs);
    for (size_t i = 0; i < COUNT; i++) {
        double wanted = -log1p(-(double)inputs[i][0]);

        assert_near((double)outputs[i][0], wanted, (inputs[i][0] < 0.5f ? 1e-6 : 1e-5) * wanted);
    }
}

static void values_without_opacity_have_exactly_none(void **state)
{
    for (size_t i = 0; i < COUNT; i++)
        inputs[i][0] = (float)(i % 2 ? 41 + 19 * (double)i / COUNT : -10.2 - (double)i);
    probe();
    for (size_t i = 0; i < COUNT; i++)
        assert_true(outputs[i][3] == 0);
}

static void greatest_opacity_of_a_range(void **state)
{
    struct random random = {32};

    for (int i = 0; i < 2000; i++) {
        double a = random_between(&random, -20, 100), b = a + random_between(&random, 0, i % 2 ? 0.1 : 60), wanted = 0;
        const struct transfer_function twin = {.points = points, .count = POINTS, .unit_distance = 1};
        double greatest = transfer_function_max_opacity(points, POINTS, a, b);

        for (int k = 0; k <= 400; k++)
            wanted = fmax(wanted, -expm1(-transfer_function_extinction(&twin, a + (b - a) * k / 400)));
        assert_true(greatest >= wanted - 1e-12);
        assert_int_equal(greatest <= 0, transfer_function_is_clear(&twin, a, b));
    }
    assert_true(transfer_function_max_opacity(points, POINTS, 41, 60) == 0);
    assert_true(transfer_function_max_opacity(points, POINTS, -INFINITY, INFINITY) == 1 - 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shader_is_its_twin),
        cmocka_unit_test(faint_opacity_keeps_its_digits),
        cmocka_unit_test(values_without_opacity_have_exactly_none),
        cmocka_unit_test(greatest_opacity_of_a_range),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
