// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_spread.h"

#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE_MOST = 9, FINER_MOST = 2 * SIDE_MOST - 1 };

// Both lattices, and the largest doubt of each finer point.
struct stand {
    int columns, rows, finer_columns, finer_rows;
    float values[4 * SIDE_MOST * SIDE_MOST], finer[4 * FINER_MOST * FINER_MOST], doubt[FINER_MOST * FINER_MOST];
};

// The value of channel c at a point, in steps of the coarser lattice.
typedef double picture(double x, double y, int c);

static void sample(struct stand *stand, int columns, int rows, picture *at)
{
    *stand =
        (struct stand){.columns = columns, .rows = rows, .finer_columns = 2 * columns - 1, .finer_rows = 2 * rows - 1};
    for (int i = 0; at && i < 4 * columns * rows; i++)
        stand->values[i] = (float)at(i / 4 % columns, i / 4 / columns, i % 4); // NOLINT(bugprone-integer-division)
}

static void spread_run(struct stand *stand, struct pixel_run run, bool is_linear)
{
    struct pixel_spread by;

    pixel_spread_init(&by, stand->values, stand->columns, stand->rows, stand->finer_columns);
    memcpy(by.scale, (float[4]){1, 2, 3, 4}, sizeof by.scale);
    memset(stand->doubt, 0, sizeof stand->doubt);
    for (int row = 0; row < stand->finer_rows; row++) {
        float *finer = stand->finer + (size_t)row * (size_t)stand->finer_columns * 4;

        if (is_linear)
            pixel_spread_row_linear(&by, row, run, finer);
        else
            pixel_spread_row(&by, row, run, finer, stand->doubt + (size_t)row * (size_t)stand->finer_columns);
    }
    pixel_spread_finish(&by);
}

static void spread(struct stand *stand, bool is_linear)
{
    spread_run(stand, (struct pixel_run){0, stand->columns}, is_linear);
}

static double finer_at(const struct stand *stand, int x, int y, int c)
{
    return stand->finer[4 * (y * stand->finer_columns + x) + c];
}

// Points up to `margin` from the edge may be anything.
static void assert_is(const struct stand *stand, picture *at, int margin)
{
    for (int y = margin; y < stand->finer_rows - margin; y++)
        for (int x = margin; x < stand->finer_columns - margin; x++)
            for (int c = 0; c < 4; c++) {
                double wanted = at(0.5 * x, 0.5 * y, c);

                assert_near(finer_at(stand, x, y, c), wanted, 1e-5 * (1 + fabs(wanted)));
            }
}

// They grow along both axes, so that no value is clamped.
static double cubic(double x, double y, int c)
{
    return (1 + x * x * x + c) * (2 + y * y * y + y);
}

static double quadratic(double x, double y, int c)
{
    return (1 + x * x) * (2 + y * (y + 1)) - c;
}

static double falling(double x, double y, int c)
{
    return quadratic(8 - x, 8 - y, c);
}

static double bilinear(double x, double y, int c)
{
    return 3 + c * x - 2 * y + 0.5 * x * y;
}

static void cubics_are_exact_inside(void **state)
{
    struct stand stand;

    (void)state;
    sample(&stand, 8, 9, cubic);
    spread(&stand, false);
    assert_is(&stand, cubic, 2);
}

static void quadratics_are_exact_up_to_the_edge(void **state)
{
    static picture *const pictures[] = {quadratic, falling};
    struct stand stand;

    (void)state;
    for (int columns = 3; columns <= 9; columns++)
        for (int i = 0; i < 2; i++) {
            sample(&stand, columns, 12 - columns, pictures[i]);
            spread(&stand, false);
            assert_is(&stand, pictures[i], 0);
        }
}

static void one_and_two_columns_are_linear(void **state)
{
    struct stand stand;

    (void)state;
    for (int columns = 1; columns <= 2; columns++)
        for (int rows = 1; rows <= 2; rows++)
            for (int is_linear = 0; is_linear < 2; is_linear++) {
                sample(&stand, columns, rows, bilinear);
                spread(&stand, is_linear != 0);
                assert_is(&stand, bilinear, 0);
            }
}

static double wavy(double x, double y, int c)
{
    return sin(x + c) * cos(2 * y);
}

// The mean of the points around.
static double mean(double x, double y, int c)
{
    return 0.25 * (wavy(floor(x), floor(y), c) + wavy(ceil(x), floor(y), c) + wavy(floor(x), ceil(y), c) +
                   wavy(ceil(x), ceil(y), c));
}

static void linear_interpolation_is_the_mean_of_the_points_around(void **state)
{
    struct stand stand;

    (void)state;
    sample(&stand, 5, 4, wavy);
    spread(&stand, true);
    assert_is(&stand, mean, 0);
}

// A finer lattice may end before the coarser one does.
static void a_shorter_row_has_the_same_values(void **state)
{
    struct stand whole, shorter;

    (void)state;
    for (int columns = 2; columns <= 9; columns++) {
        sample(&whole, columns, 3, wavy);
        shorter = whole;
        shorter.finer_columns--;
        spread(&whole, false);
        spread(&shorter, false);
        for (int i = 0; i < shorter.finer_columns * shorter.finer_rows; i++)
            for (int c = 0; c < 4; c++) {
                int x = i % shorter.finer_columns, y = i / shorter.finer_columns;

                assert_near(finer_at(&shorter, x, y, c), finer_at(&whole, x, y, c), 0);
            }
    }
}

static void assert_in_range_of_taps(const struct stand *stand, int x, int y, int c)
{
    int left = x % 2 == 1 ? x / 2 - 1 : x / 2, right = x % 2 == 1 ? x / 2 + 2 : x / 2;
    int top = y % 2 == 1 ? y / 2 - 1 : y / 2, bottom = y % 2 == 1 ? y / 2 + 2 : y / 2;
    double low = INFINITY, high = -INFINITY;

    for (int row = top; row <= bottom; row++)
        for (int column = left; column <= right; column++) {
            double tap;

            if (row < 0 || column < 0 || row >= stand->rows || column >= stand->columns) continue;
            tap = stand->values[4 * (row * stand->columns + column) + c];
            low = fmin(low, tap);
            high = fmax(high, tap);
        }
    assert_true(finer_at(stand, x, y, c) >= low && finer_at(stand, x, y, c) <= high);
}

static void values_stay_within_the_range_of_their_points(void **state)
{
    struct random random = {11};
    struct stand stand;

    (void)state;
    for (int trial = 0; trial < 60; trial++) {
        sample(&stand, 1 + trial % 7, 1 + trial % 5, NULL);
        for (int i = 0; i < 4 * stand.columns * stand.rows; i++) {
            double value = random_between(&random, 0, 1); // hard steps, and what lies between

            stand.values[i] = value < 0.4 ? 0.0f : value < 0.8 ? 1.0f : (float)value;
        }
        spread(&stand, false);
        for (int i = 0; i < 4 * stand.finer_columns * stand.finer_rows; i++)
            assert_in_range_of_taps(&stand, i / 4 % stand.finer_columns, i / 4 / stand.finer_columns, i % 4);
    }
}

// The second differences of 0, 1, 2, 5 are 0 and 2, and a line half way between 1 and 2 is off by their eighth.
static void doubt_is_the_larger_weighted_bend(void **state)
{
    static const double rows[][4] = {{0, 1, 2, 5}, {5, 2, 1, 0}, {0, -1, -2, -5}};
    struct stand stand;

    (void)state;
    for (int channel = 0; channel < 4; channel++)
        for (int i = 0; i < 3; i++) {
            sample(&stand, 4, 1, NULL);
            for (int x = 0; x < 4; x++)
                stand.values[4 * x + channel] = (float)rows[i][x];
            spread(&stand, false);
            assert_near(stand.doubt[3], 0.25 * (channel + 1), 1e-6);
            for (int x = 0; x < 7; x += 2)
                assert_near(stand.doubt[x], 0, 0);
        }
}

// A cubic through the four points around half a step, or through points that alternate, is as far up as a line.
static void steps_and_what_alternates_are_doubted(void **state)
{
    static const double step[] = {0, 0, 1, 1}, alternate[] = {0, 1, 0, 1};
    const double *rows[] = {step, alternate};
    struct stand stand;

    (void)state;
    for (int i = 0; i < 4; i++) {
        bool is_down = i % 2 == 1;

        sample(&stand, is_down ? 1 : 4, is_down ? 4 : 1, NULL);
        for (size_t x = 0; x < 4; x++)
            stand.values[4 * x] = (float)rows[i / 2][x];
        spread(&stand, false);
        for (int x = 1; x < 7; x += 2)
            assert_near(stand.doubt[x], i < 2 ? 0.125 : 0.25, 0);
    }
}

// Of y² it is found in the lattice's columns, of x² in every row.
static void doubt_is_found_along_both_axes(void **state)
{
    struct stand stand;

    (void)state;
    for (int axis = 0; axis < 2; axis++) {
        sample(&stand, 5, 5, NULL);
        for (int i = 0; i < 25; i++) {
            int at = axis == 0 ? i % 5 : i / 5;

            stand.values[4 * i] = (float)(at * at);
        }
        spread(&stand, false);
        for (int i = 0; i < 81; i++) {
            int x = i % 9, y = i / 9;

            assert_near(stand.doubt[i], (axis == 0 ? x % 2 == 1 : y % 2 == 1 && x % 2 == 0) ? 0.25 : 0, 1e-6);
        }
    }
}

static void points_of_the_lattice_stay_to_the_bit(void **state)
{
    struct stand stand;

    (void)state;
    sample(&stand, 7, 6, wavy);
    spread(&stand, false);
    for (int i = 0; i < 42; i++)
        assert_memory_equal(&stand.finer[4 * (2 * (i / 7) * 13 + 2 * (i % 7))], &stand.values[4 * i], 16);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubics_are_exact_inside),
        cmocka_unit_test(quadratics_are_exact_up_to_the_edge),
        cmocka_unit_test(one_and_two_columns_are_linear),
        cmocka_unit_test(linear_interpolation_is_the_mean_of_the_points_around),
        cmocka_unit_test(a_shorter_row_has_the_same_values),
        cmocka_unit_test(values_stay_within_the_range_of_their_points),
        cmocka_unit_test(doubt_is_the_larger_weighted_bend),
        cmocka_unit_test(steps_and_what_alternates_are_doubted),
        cmocka_unit_test(doubt_is_found_along_both_axes),
        cmocka_unit_test(points_of_the_lattice_stay_to_the_bit),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
