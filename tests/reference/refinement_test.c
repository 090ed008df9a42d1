// SPDX-License-Identifier: Apache-2.0
#include "reference/refinement.h"

#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { COUNT = 50 };

struct cell {
    double begin, error, end;
};

static struct refinement cells_of(const struct cell *cells, size_t count)
{
    return (struct refinement){&cells[0].error, sizeof cells[0], count};
}

static void errors_of_cells_add_as_squares(void **state)
{
    const struct cell cells[] = {{9.0, 3.0, 9.0}, {9.0, 4.0, 9.0}, {9.0, 12.0, 9.0}, {9.0, 100.0, 9.0}};
    struct refinement three = cells_of(cells, 3);

    assert_near(refinement_error(&three), 13.0, 1e-14);
}

static void cells_that_are_kept_are_within_what_is_allowed(void **state)
{
    struct random random = {5};

    for (int round = 0; round < 500; round++) {
        struct cell cells[COUNT] = {{0.0, 0.0, 0.0}};
        struct refinement refinement = cells_of(cells, COUNT);
        double allowed = exp(random_between(&random, -5.0, 1.0)), kept = 0.0, limit;
        size_t refined = 0;

        for (int i = 0; i < COUNT; i++)
            cells[i].error = exp(random_between(&random, -9.0, 0.0));
        if (!(refinement_error(&refinement) > allowed)) continue;
        limit = refinement_limit(&refinement, allowed);
        for (int i = 0; i < COUNT; i++) {
            if (cells[i].error > limit) {
                refined++;
            } else {
                kept += cells[i].error * cells[i].error;
            }
        }
        assert_true(refined > 0);
        assert_true(sqrt(kept) < allowed);
    }
}

static void one_large_error_is_refined_alone(void **state)
{
    struct cell cells[COUNT] = {{0.0, 0.0, 0.0}};
    struct refinement refinement = cells_of(cells, COUNT);

    for (int i = 0; i < COUNT; i++)
        cells[i].error = 1e-3;
    cells[31].error = 1.0;
    assert_true(refinement_limit(&refinement, 0.1) >= 1e-3);
}

// A thick cell has an infinite error until it is thin, which takes many halvings.
static void infinite_errors_leave_the_others_alone(void **state)
{
    struct cell cells[COUNT] = {{0.0, 0.0, 0.0}};
    struct refinement refinement = cells_of(cells, COUNT);

    for (int i = 0; i < COUNT; i++)
        cells[i].error = 1e-3 * i;
    cells[17].error = INFINITY;
    assert_true(refinement_error(&refinement) == INFINITY);
    assert_true(refinement_limit(&refinement, 1.0) >= 49e-3);
    assert_true(refinement_limit(&refinement, 0.1) < 49e-3);
}

static void halves_are_doubted_where_their_sum_differs_from_the_whole(void **state)
{
    double first = 0.0, second = 7.0;

    refinement_doubt(&first, &second, -4.0);
    assert_near(first, 1.0, 0.0);
    assert_near(second, 7.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_of_cells_add_as_squares),
        cmocka_unit_test(cells_that_are_kept_are_within_what_is_allowed),
        cmocka_unit_test(one_large_error_is_refined_alone),
        cmocka_unit_test(infinite_errors_leave_the_others_alone),
        cmocka_unit_test(halves_are_doubted_where_their_sum_differs_from_the_whole),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
