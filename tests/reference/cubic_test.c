// SPDX-License-Identifier: Apache-2.0
#include "reference/cubic.h"

#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include <cmocka.h>

// Coefficients of (s - a)(s - b)(s - c).
static void from_roots(double a, double b, double c, double cubic[static 4])
{
    cubic[0] = -a * b * c;
    cubic[1] = a * b + b * c + c * a;
    cubic[2] = -(a + b + c);
    cubic[3] = 1.0;
}

static void finds_all_crossings_in_order(void **state)
{
    double cubic[4], crossings[3];

    from_roots(0.8, 0.1, 0.3, cubic);
    assert_int_equal(cubic_find_crossings(cubic, 0.0, crossings), 3);
    assert_near(crossings[0], 0.1, 1e-14);
    assert_near(crossings[1], 0.3, 1e-14);
    assert_near(crossings[2], 0.8, 1e-14);
    from_roots(-0.5, 0.6, 1.5, cubic);
    assert_int_equal(cubic_find_crossings(cubic, 0.0, crossings), 1);
    assert_near(crossings[0], 0.6, 1e-14);
}

static void finds_crossings_of_lower_degrees(void **state)
{
    static const double LINE[4] = {-0.25, 1.0, 0.0, 0.0}, EVEN[4] = {0.7, 0.0, 0.0, 0.0};
    static const double PARABOLA[4] = {0.16, -1.0, 1.0, 0.0};
    double crossings[3];

    assert_int_equal(cubic_find_crossings(LINE, 0.25, crossings), 1);
    assert_near(crossings[0], 0.5, 1e-15);
    assert_int_equal(cubic_find_crossings(EVEN, 0.7, crossings), 0);
    assert_int_equal(cubic_find_crossings(PARABOLA, 0.0, crossings), 2);
    assert_near(crossings[0], 0.2, 1e-15);
    assert_near(crossings[1], 0.8, 1e-15);
}

// The value stays on one side of the level between two successive crossings.
static void misses_no_crossing(void **state)
{
    struct random random = {21};
    int found = 0;

    for (int i = 0; i < 20000; i++) {
        double cubic[4], crossings[3], level = random_between(&random, -0.5, 0.5);
        int count;

        for (int n = 0; n < 4; n++)
            cubic[n] = random_between(&random, -1.0, 1.0) * (n < 3 || i % 2 ? 1.0 : 1e-9);
        count = cubic_find_crossings(cubic, level, crossings);
        for (int k = 0; k < 20; k++) {
            double s = random_between(&random, 0.0, 1.0);
            bool is_above = cubic_at(cubic, 0.0) > level;

            // 1e-12: rounding decides the side nearer to the level.
            if (fabs(cubic_at(cubic, s) - level) < 1e-12) continue;
            for (int n = 0; n < count; n++)
                is_above ^= crossings[n] < s;
            assert_true(is_above == (cubic_at(cubic, s) > level));
        }
        found += count > 1;
    }
    assert_true(found > 100);
}

static void integral_is_that_of_each_power(void **state)
{
    static const double CUBIC[4] = {1.0, 2.0, 3.0, 4.0};

    assert_near(cubic_integral(CUBIC, 0.0, 1.0), 4.0, 1e-15);
    assert_near(cubic_integral(CUBIC, 0.5, 1.0), 4.0 - (0.5 + 0.25 + 0.125 + 0.0625), 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_all_crossings_in_order),
        cmocka_unit_test(finds_crossings_of_lower_degrees),
        cmocka_unit_test(misses_no_crossing),
        cmocka_unit_test(integral_is_that_of_each_power),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
