// Running integrals of transfer functions against closed forms and plain sums.
// SPDX-License-Identifier: Apache-2.0
#include "worker/density/transfer_table.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static float table[TRANSFER_TABLE_SIZE][4];

// Returns the table's mean between two values, per unit of value.
static double mean(double first, double last, double low, double high, int c)
{
    double width = (last - first) / TRANSFER_TABLE_CELLS;
    int from = 1 + (int)lround((low - first) / width), to = 1 + (int)lround((high - first) / width);

    return ((double)table[to][c] - (double)table[from][c]) / (to - from);
}

// The integral of -ln(1 - b v) over [0, 1] is ((1 - b) ln(1 - b) + b) / b.
static void a_ramp_has_its_closed_form(void **state)
{
    static const struct scene_transfer_point points[] = {{2, {0, 0.5, 1, 0}}, {6, {1, 0.5, 1, 0.9}}};
    double b = 0.9, whole = ((1 - b) * log(1 - b) + b) / b;
    // By parts: half of -ln(1 - b) less the integral of b v^2 / (1 - b v).
    double weighted = 0.5 * (-log(1 - b) - (-log(1 - b) / (b * b) - 1 / b - 0.5));

    (void)state;
    transfer_table_fill(points, 2, table);
    assert_near(mean(2, 6, 2, 6, 3), whole, 1e-6);
    assert_near(mean(2, 6, 2, 6, 0), weighted, 1e-6);
    assert_near(mean(2, 6, 2, 6, 1), 0.5 * whole, 1e-6);
    assert_near(mean(2, 6, 2, 6, 2), whole, 1e-6);
    // Where it holds.
    assert_near(table[1][3], 0, 1e-9);
    assert_near((double)table[TRANSFER_TABLE_SIZE - 1][3] - (double)table[TRANSFER_TABLE_SIZE - 2][3], -log(0.1), 1e-4);
}

// Far narrower than a cell, yet none of it is lost.
static void a_spike_between_nodes_is_whole(void **state)
{
    static const struct scene_transfer_point points[] = {{0, {1, 1, 1, 0}},
                                                         {500.3, {1, 1, 1, 0}},
                                                         {500.35, {1, 0.25, 1, 0.99}},
                                                         {500.4, {1, 1, 1, 0}},
                                                         {1024, {1, 1, 1, 0}}};
    double b = 0.99, area = 0.1 * ((1 - b) * log(1 - b) + b) / b;

    (void)state;
    transfer_table_fill(points, 5, table);
    assert_near(mean(0, 1024, 500, 501, 3), area, 1e-5);
    assert_near(mean(0, 1024, 0, 500, 3), 0, 1e-12);
    assert_true(mean(0, 1024, 500, 501, 1) < 0.6 * area);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ramp_has_its_closed_form),
        cmocka_unit_test(a_spike_between_nodes_is_whole),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
