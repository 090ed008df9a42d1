// SPDX-License-Identifier: Apache-2.0
#include "reference/column.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct ray ALONG_X = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};

// Waves over an even density; counts how often it is evaluated.
struct waves {
    double density, height, frequency;
    int *evaluations; // borrowed
};

static double waves_at(const void *field, struct vec3 position)
{
    const struct waves *waves = field;

    ++*waves->evaluations;
    return waves->density + waves->height * sin(waves->frequency * position.x);
}

static void whole_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    span_list_append(spans, near, far, NULL);
}

static struct density density_of(const struct waves *waves)
{
    return (struct density){.field = waves, .at = waves_at, .spans = whole_spans};
}

static double column_of(const struct waves *waves, double far)
{
    return waves->density * far + waves->height / waves->frequency * (1.0 - cos(waves->frequency * far));
}

// Up to three waves: spans are to be so short that their nodes see what is in them.
static void every_tolerance_is_kept(void **state)
{
    for (double frequency = 0.5; frequency < 10.0; frequency += 0.1) {
        int evaluations = 0;
        struct waves waves = {2.0, 1.0, frequency, &evaluations};
        struct density density = density_of(&waves);

        for (double asked = 0.1; asked > 1e-9; asked *= 0.1)
            assert_near(column_integrate(&density, &ALONG_X, 0.0, 2.0, &(struct column_accuracy){.error = asked}),
                        column_of(&waves, 2.0), asked);
    }
}

// What is asked of the light that passes is kept for each extinction between the two.
static void light_that_passes_is_as_exact_as_asked(void **state)
{
    static const double SIGMAS[] = {0.3, 1.0, 3.0};

    for (double density_value = 0.5; density_value < 50.0; density_value *= 1.7) {
        for (double asked = 0.1; asked > 1e-6; asked *= 0.1) {
            int evaluations = 0;
            struct waves waves = {density_value, 0.5, 40.0, &evaluations};
            struct density density = density_of(&waves);
            const struct column_accuracy accuracy = {.error = 1e-9, .light = asked, .sigma_min = 0.3, .sigma_max = 3.0};
            double column = column_integrate(&density, &ALONG_X, 0.0, 2.0, &accuracy);

            for (int i = 0; i < 3; i++)
                assert_near(exp(-SIGMAS[i] * column), exp(-SIGMAS[i] * column_of(&waves, 2.0)), asked);
        }
    }
}

static int count_evaluations(double density_value, const struct column_accuracy *accuracy)
{
    int evaluations = 0;
    struct waves waves = {density_value, 0.5, 40.0, &evaluations};
    struct density density = density_of(&waves);

    column_integrate(&density, &ALONG_X, 0.0, 2.0, accuracy);
    return evaluations;
}

static void dark_columns_take_one_look(void **state)
{
    const struct column_accuracy by_column = {.error = 1e-9};
    const struct column_accuracy by_light = {.error = 1e-9, .light = 1e-3, .sigma_min = 1.0, .sigma_max = 1.0};

    assert_int_equal(count_evaluations(100.0, &by_light), 3);
    assert_true(count_evaluations(100.0, &by_column) > 100);
    // Light passes here: it has to be seen how much.
    assert_in_range(count_evaluations(1.0, &by_light), 7, count_evaluations(1.0, &by_column));
}

static void a_quarter_wave_and_nothing_are_exact(void **state)
{
    int evaluations = 0;
    struct waves waves = {0.0, 1.0, 0.5 * M_PI, &evaluations};
    struct density density = density_of(&waves);

    // A quarter of a wave rises from 0 to 1.
    assert_near(column_integrate(&density, &ALONG_X, 0.0, 1.0, &(struct column_accuracy){.error = 1e-12}), 2.0 / M_PI,
                1e-12);
    assert_near(column_integrate(&density, &ALONG_X, 0.5, 0.5, &(struct column_accuracy){.error = 1e-12}), 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_tolerance_is_kept),
        cmocka_unit_test(light_that_passes_is_as_exact_as_asked),
        cmocka_unit_test(dark_columns_take_one_look),
        cmocka_unit_test(a_quarter_wave_and_nothing_are_exact),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
