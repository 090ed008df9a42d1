// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/gauss_legendre.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// The integrand is x^power, whose integral from 0 to x is x^(power + 1) / (power + 1).
static void partials_integrate_polynomials(void **state)
{
    for (int count = 1; count <= GAUSS_LEGENDRE_PARTIAL_LIMIT; ++count) {
        double points[GAUSS_LEGENDRE_PARTIAL_LIMIT], weights[GAUSS_LEGENDRE_PARTIAL_LIMIT];
        double partials[GAUSS_LEGENDRE_PARTIAL_LIMIT * GAUSS_LEGENDRE_PARTIAL_LIMIT];

        gauss_legendre(count, points, weights);
        gauss_legendre_partials(count, partials);
        for (int power = 0; power < count; ++power)
            for (int i = 0; i < count; ++i) {
                double sum = 0;

                for (int k = 0; k < count; ++k)
                    sum += partials[i * count + k] * pow(points[k], power);
                assert_true(fabs(sum - pow(points[i], power + 1) / (power + 1)) < 1e-13);
            }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(partials_integrate_polynomials)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
