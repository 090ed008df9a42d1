// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_guard.h"

#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { COLUMNS = 23, ROWS = 14, STRIDE = 8 };

struct marks {
    uint8_t forced[ROWS][COLUMNS];
};

static struct marks mark(struct pixel_guard guard)
{
    struct marks marks = {0};

    pixel_guard_mark(&guard, STRIDE, COLUMNS, ROWS, marks.forced[0]);
    return marks;
}

static int count(const struct marks *marks)
{
    int sum = 0;

    for (int i = 0; i < COLUMNS * ROWS; i++)
        sum += marks->forced[i / COLUMNS][i % COLUMNS];
    return sum;
}

static bool is_marked(const struct marks *marks, int column, int row)
{
    return column < 0 || row < 0 || column >= COLUMNS || row >= ROWS || marks->forced[row][column];
}

static void a_point_marks_the_points_around_it(void **state)
{
    (void)state;
    for (int reach = 1; reach <= 3; reach++) {
        struct marks marks = mark((struct pixel_guard){{83, 50}, {83, 50}, reach}); // in steps 10.4 and 6.25

        assert_int_equal(count(&marks), 4 * reach * reach);
        for (int row = 6 - reach + 1; row <= 6 + reach; row++)
            for (int column = 10 - reach + 1; column <= 10 + reach; column++)
                assert_true(is_marked(&marks, column, row));
    }
}

static void a_point_at_the_edge_marks_what_is_inside(void **state)
{
    struct marks marks = mark((struct pixel_guard){{-3, -3}, {-3, -3}, 1});

    (void)state;
    assert_int_equal(count(&marks), 1);
    assert_true(marks.forced[0][0]);
    marks = mark((struct pixel_guard){{STRIDE * (COLUMNS - 1) + 7, 40}, {STRIDE * (COLUMNS - 1) + 7, 40}, 1});
    assert_int_equal(count(&marks), 2);
    marks = mark((struct pixel_guard){{-9, 40}, {-9, 40}, 1});
    assert_int_equal(count(&marks), 0);
}

// What is drawn along a line between any points of it, and nothing away from it.
static void a_line_marks_what_it_passes_and_no_more(void **state)
{
    struct random random = {7};

    (void)state;
    for (int trial = 0; trial < 200; trial++) {
        struct pixel_guard guard = {.reach = 1};
        struct marks marks;
        bool is_near[ROWS][COLUMNS] = {{false}};

        for (int i = 0; i < 2; i++) {
            guard.from[i] = random_between(&random, -100, 250);
            guard.to[i] = random_between(&random, -100, 250);
        }
        marks = mark(guard);
        for (int step = 0; step <= 5000; step++) {
            double x = (guard.from[0] + step / 5000.0 * (guard.to[0] - guard.from[0])) / STRIDE;
            double y = (guard.from[1] + step / 5000.0 * (guard.to[1] - guard.from[1])) / STRIDE;
            int left = (int)floor(x), top = (int)floor(y), around = 0;

            for (int i = 0; i < 4; i++) {
                int column = left + i % 2, row = top + i / 2;

                around += is_marked(&marks, column, row);
                if (column >= 0 && row >= 0 && column < COLUMNS && row < ROWS) is_near[row][column] = true;
            }
            // A line that cuts a corner off a square, shorter than half a step, may leave the opposite one.
            if (x > 0 && y > 0 && x < COLUMNS - 1 && y < ROWS - 1) assert_true(around >= 3);
        }
        for (int i = 0; i < COLUMNS * ROWS; i++)
            assert_true(is_near[i / COLUMNS][i % COLUMNS] || !marks.forced[i / COLUMNS][i % COLUMNS]);
    }
}

static void far_ends_are_clipped(void **state)
{
    struct marks near = mark((struct pixel_guard){{-1000, 50}, {1000, 50}, 1});
    struct marks far = mark((struct pixel_guard){{-1e15, 50}, {1e15, 50}, 1});

    (void)state;
    assert_int_equal(count(&near), 2 * COLUMNS);
    assert_memory_equal(&near, &far, sizeof near);
    far = mark((struct pixel_guard){{-1e15, -50}, {1e15, -50}, 1});
    assert_int_equal(count(&far), 0);
}

static void places_that_are_no_numbers_mark_nothing(void **state)
{
    static const double odd[] = {NAN, INFINITY, -INFINITY, 1.7e308, -1.7e308};

    (void)state;
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
        for (int where = 0; where < 4; where++) {
            struct pixel_guard guard = {.from = {50, 50}, .to = {60, 50}, .reach = 1};
            struct marks marks;

            *(where < 2 ? &guard.from[where] : &guard.to[where - 2]) = odd[i];
            marks = mark(guard);
            assert_true(count(&marks) <= COLUMNS * ROWS);
            if (isnan(odd[i])) assert_int_equal(count(&marks), 0);
        }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_marks_the_points_around_it),
        cmocka_unit_test(a_point_at_the_edge_marks_what_is_inside),
        cmocka_unit_test(a_line_marks_what_it_passes_and_no_more),
        cmocka_unit_test(far_ends_are_clipped),
        cmocka_unit_test(places_that_are_no_numbers_mark_nothing),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
