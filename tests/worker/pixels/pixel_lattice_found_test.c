// How large a feature is that a lattice finds wherever it is.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/assert_near.h"
#include "tests/support/lattice_picture.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

struct disc {
    double x, y, radius;
};

static struct lattice_point disc(const void *user, int x, int y)
{
    const struct disc *disc = user;
    float value = hypot(x - disc->x, y - disc->y) <= disc->radius ? 2.0f : 0.25f;

    return (struct lattice_point){.rgba = {value, value, value, 1}};
}

// The share of discs at random places of which nothing is missing.
static double find_share(int stride, double width)
{
    enum { TRIALS = 200 };
    struct random random = {5};
    int found = 0;

    for (int i = 0; i < TRIALS; i++) {
        struct disc user = {random_between(&random, 24, 56), random_between(&random, 24, 56), 0.5 * width};
        struct lattice_case of = {.width_px = 81,
                                  .height_px = 79,
                                  .stride = stride,
                                  .threshold = 0.01,
                                  .is_colour_only = true,
                                  .picture = disc,
                                  .user = &user};
        struct lattice_made made = lattice_make(&of);

        lattice_check_traced(&of, &made);

        found += lattice_find_error(&of, &made) < 0.01;
        lattice_made_finish(&made);
    }
    return (double)found / TRIALS;
}

// Any circle as wide as a square's diagonal has one of the points of a lattice in it.
static void discs_wider_than_a_square_s_diagonal_are_found(void **state)
{
    (void)state;
    assert_near(find_share(16, 1.5 * 16), 1, 0);
    assert_near(find_share(4, 1.5 * 4), 1, 0);
    assert_near(find_share(16, 0.5 * 16), 0.25 * 3.14159 / 4, 0.08); // a disc's share of a square
}

// A shallow parabola along x.
static struct lattice_point bowl(const void *user, int x, int y)
{
    float value = (float)(1 + 1e-4 * x * x);

    (void)user;
    (void)y;
    return (struct lattice_point){.rgba = {value, value, value, 1}};
}

// The cubic is exact for such a picture, so that the error is what is interpolated linearly.
static void calm_pictures_are_off_by_a_sixtieth_of_the_threshold(void **state)
{
    double worst = 0.0;

    (void)state;
    for (double scale = 1; scale < 200; scale *= 1.3) {
        struct lattice_case of = {
            .width_px = 257, .height_px = 9, .stride = 8, .threshold = scale * 1e-4, .picture = bowl};
        struct lattice_made made = lattice_make(&of);
        double squares = 0.0, share;

        for (int x = 0; x < 257; x += 8)
            squares += (1 + 1e-4 * x * x) * (1 + 1e-4 * x * x);
        share = lattice_find_error(&of, &made) / (of.threshold * sqrt(squares / 33));
        assert_true(share < 1.0 / 60);
        worst = fmax(worst, share);
        lattice_made_finish(&made);
    }
    assert_true(worst > 1.0 / 120); // some are
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(calm_pictures_are_off_by_a_sixtieth_of_the_threshold),
                                       cmocka_unit_test(discs_wider_than_a_square_s_diagonal_are_found)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
