// SPDX-License-Identifier: Apache-2.0
#include "reference/perlin.h"

#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

struct points {
    double x[PERLIN_BATCH], y[PERLIN_BATCH], z[PERLIN_BATCH];
};

// Near the origin, far away, and on lattice planes.
static double random_coordinate(struct random *random)
{
    double kind = random_between(random, 0.0, 3.0);

    if (kind < 1.0) return random_between(random, -3.0, 3.0);
    if (kind < 2.0) return random_between(random, -1e9, 1e9);
    return floor(random_between(random, -300.0, 300.0));
}

static void fill(struct points *points, struct random *random)
{
    for (int i = 0; i < PERLIN_BATCH; i++) {
        points->x[i] = random_coordinate(random);
        points->y[i] = random_coordinate(random);
        points->z[i] = random_coordinate(random);
    }
}

static void several_points_have_the_bits_that_each_has_alone(void **state)
{
    struct random random = {11};
    struct points points;

    for (int round = 0; round < 2000; round++) {
        double together[PERLIN_BATCH], alone[PERLIN_BATCH];
        size_t count = 1 + (size_t)round % PERLIN_BATCH;

        fill(&points, &random);
        perlin_noise(count, points.x, points.y, points.z, together);
        for (size_t i = 0; i < count; i++)
            perlin_noise(1, &points.x[i], &points.y[i], &points.z[i], &alone[i]);
        assert_memory_equal(together, alone, count * sizeof alone[0]);
    }
}

// The instructions of this machine against those that every machine has.
static void machines_agree_to_the_last_bit(void **state)
{
    struct random random = {12};
    struct points points;

    for (int round = 0; round < 2000; round++) {
        double own[PERLIN_BATCH], plain[PERLIN_BATCH];

        fill(&points, &random);
        perlin_noise(PERLIN_BATCH, points.x, points.y, points.z, own);
        perlin_noise_plain(PERLIN_BATCH, points.x, points.y, points.z, plain);
        assert_memory_equal(own, plain, sizeof own);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(several_points_have_the_bits_that_each_has_alone),
        cmocka_unit_test(machines_agree_to_the_last_bit),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
