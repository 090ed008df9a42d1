// SPDX-License-Identifier: Apache-2.0
#include "reference/kronrod.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const int COUNTS[] = {GAUSS_NODES, KRONROD_NODES};
// The highest powers that the rules integrate exactly.
static const int POWERS[] = {5, 11};

// Roundings of a sum of seven.
static const double ROUNDING = 1e-15;

static double integrate_power(int power, int count, double *error)
{
    double values[KRONROD_NODES];

    for (int i = 0; i < count; i++)
        values[i] = pow(kronrod_nodes[i], power);
    return kronrod_integrate(values, count, 1.0, error);
}

static void powers_are_integrated_exactly(void **state)
{
    for (int k = 0; k < 2; k++) {
        double error;

        for (int power = 0; power <= POWERS[k]; power++)
            assert_near(integrate_power(power, COUNTS[k], &error), 1.0 / (power + 1), ROUNDING);
        assert_true(fabs(integrate_power(POWERS[k] + 1, COUNTS[k], &error) - 1.0 / (POWERS[k] + 2)) > 1e-9);
    }
}

static void integrals_up_to_a_node_are_exact_for_the_nodes_polynomial(void **state)
{
    for (int k = 0; k < 2; k++) {
        for (int node = 0; node < COUNTS[k]; node++) {
            const double *weights = kronrod_partial_weights(COUNTS[k], node);

            for (int power = 0; power < COUNTS[k]; power++) {
                double sum = 0.0;

                for (int i = 0; i < COUNTS[k]; i++)
                    sum += weights[i] * pow(kronrod_nodes[i], power);
                assert_near(sum, pow(kronrod_nodes[node], power + 1) / (power + 1), ROUNDING);
            }
        }
    }
}

enum { SMOOTH, PEAK, KINK, SHAPES, PLACES = 999 };

static double value_at(int shape, double at, double place)
{
    if (shape == SMOOTH) return exp(3.0 * at);
    if (shape == PEAK) return 1.0 / (0.05 + (at - place) * (at - place));
    return fmax(at - place, 0.0);
}

static double integral_of(int shape, double place)
{
    if (shape == SMOOTH) return (exp(3.0) - 1.0) / 3.0;
    if (shape == PEAK) return (atan((1.0 - place) / sqrt(0.05)) + atan(place / sqrt(0.05))) / sqrt(0.05);
    return 0.5 * (1.0 - place) * (1.0 - place);
}

// The number of places of PLACES where the error exceeds its estimate.
static int count_exceeded(int shape, int count)
{
    int exceeded = 0;

    for (int i = 1; i <= PLACES; i++) {
        double values[KRONROD_NODES], error, place = i / (PLACES + 1.0), found;

        for (int n = 0; n < count; n++)
            values[n] = value_at(shape, kronrod_nodes[n], place);
        found = kronrod_integrate(values, count, 1.0, &error);
        if (fabs(found - integral_of(shape, place)) > error) exceeded++;
    }
    return exceeded;
}

// An estimate from a few nodes may be small by accident, and no node sees a kink beyond the last one:
// refinement_doubt() is for these.
static void most_errors_are_within_their_estimates(void **state)
{
    static const int MOST[SHAPES] = {[SMOOTH] = 0, [PEAK] = PLACES / 10, [KINK] = PLACES / 5};

    for (int shape = 0; shape < SHAPES; shape++) {
        for (int k = 0; k < 2; k++)
            assert_in_range(count_exceeded(shape, COUNTS[k]), 0, MOST[shape]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(powers_are_integrated_exactly),
        cmocka_unit_test(integrals_up_to_a_node_are_exact_for_the_nodes_polynomial),
        cmocka_unit_test(most_errors_are_within_their_estimates),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
