// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/grid_bricks.h"

#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static int larger(int a, int b)
{
    return a > b ? a : b;
}

static double random_value(struct random *random, enum volume_type type)
{
    switch (type) {
    case VOLUME_UINT8:
        return floor(random_between(random, 0, 256));
    case VOLUME_UINT16:
        return floor(random_between(random, 0, 65536));
    case VOLUME_INT16:
        return floor(random_between(random, -32768, 32768));
    case VOLUME_FLOAT32:
        break;
    }
    return (float)random_between(random, -1e6, 1e6);
}

static void store(void *voxels, enum volume_type type, size_t at, double value)
{
    switch (type) {
    case VOLUME_UINT8:
        ((uint8_t *)voxels)[at] = (uint8_t)value;
        return;
    case VOLUME_UINT16:
        ((uint16_t *)voxels)[at] = (uint16_t)value;
        return;
    case VOLUME_INT16:
        ((int16_t *)voxels)[at] = (int16_t)value;
        return;
    case VOLUME_FLOAT32:
        ((float *)voxels)[at] = (float)value;
        return;
    }
}

static struct grid_bound find_bound(const double *values, const int size[3], const int brick[3])
{
    struct grid_bound bound = {INFINITY, -INFINITY};

    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++)
            for (int i = 0; i < size[0]; i++) {
                const int at[3] = {i, j, k};
                bool is_reached = true;

                for (int axis = 0; axis < 3; axis++)
                    is_reached = is_reached && at[axis] >= 8 * brick[axis] && at[axis] <= 8 * brick[axis] + 8;
                if (!is_reached) continue;
                bound.min = fminf(bound.min, (float)values[(k * size[1] + j) * size[0] + i]);
                bound.max = fmaxf(bound.max, (float)values[(k * size[1] + j) * size[0] + i]);
            }
    return bound;
}

static void check_bounds(const int size[3], enum volume_type type, int slab)
{
    struct random random = {7};
    size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2], slice = (size_t)size[0] * (size_t)size[1];
    double *values = calloc(count, sizeof *values);
    char *voxels = calloc(count, volume_type_size(type));
    struct grid_bricks bricks;
    size_t at = 0;

    for (size_t i = 0; i < count; i++) {
        values[i] = random_value(&random, type);
        store(voxels, type, i, values[i]);
    }
    assert_true(grid_bricks_init(&bricks, size, NULL));
    for (int k = 0; k < size[2]; k += slab)
        grid_bricks_add(&bricks, type, voxels + (size_t)k * slice * volume_type_size(type), k,
                        slab < size[2] - k ? slab : size[2] - k);
    for (int k = 0; k < bricks.count[2]; k++)
        for (int j = 0; j < bricks.count[1]; j++)
            for (int i = 0; i < bricks.count[0]; i++, at++) {
                struct grid_bound wanted = find_bound(values, size, (int[]){i, j, k});

                assert_true(bricks.bounds[at].min == wanted.min && bricks.bounds[at].max == wanted.max);
            }
    grid_bricks_finish(&bricks);
    free(voxels);
    free(values);
}

static void bounds_cover_what_interpolation_reaches(void **state)
{
    for (enum volume_type type = VOLUME_UINT8; type <= VOLUME_FLOAT32; type++)
        for (int slab = 1; slab < 20; slab += 6)
            check_bounds((int[]){19, 17, 25}, type, slab);
}

static void volumes_smaller_than_a_brick_have_one(void **state)
{
    check_bounds((int[]){1, 1, 1}, VOLUME_UINT8, 1);
    check_bounds((int[]){2, 1, 1}, VOLUME_FLOAT32, 1);
    check_bounds((int[]){8, 8, 8}, VOLUME_INT16, 3);
    check_bounds((int[]){9, 8, 1}, VOLUME_UINT16, 1);
}

static bool is_not_positive(double min, double max, const void *user)
{
    return max <= 0;
}

static void distances_are_to_the_nearest_full_brick(void **state)
{
    struct random random = {3};
    const int size[3] = {88, 56, 72};
    struct grid_bricks bricks;
    unsigned char distances[11 * 7 * 9];

    for (int density = 0; density < 4; density++) {
        assert_true(grid_bricks_init(&bricks, size, NULL));
        for (int i = 0; i < 11 * 7 * 9; i++) {
            bool is_full = random_between(&random, 0, 1) < (const double[]){0.004, 0.02, 0.5, 0}[density];

            // Slope -2 and intercept 1 make the stored 0 the value 1 and the stored 1 the value -1.
            bricks.bounds[i] = (struct grid_bound){is_full ? 0 : 1, 1};
        }
        grid_bricks_find_distances(&bricks, -2, 1, is_not_positive, NULL, distances);
        for (int i = 0; i < 11 * 7 * 9; i++) {
            int wanted = GRID_BRICK_FAR;

            for (int k = 0; k < 11 * 7 * 9; k++) {
                int away = larger(larger(abs(i % 11 - k % 11), abs(i / 11 % 7 - k / 11 % 7)), abs(i / 77 - k / 77));

                if (bricks.bounds[k].min < 0.5f && away < wanted) wanted = away;
            }
            assert_int_equal(distances[i], wanted);
        }
        grid_bricks_finish(&bricks);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_cover_what_interpolation_reaches),
        cmocka_unit_test(volumes_smaller_than_a_brick_have_one),
        cmocka_unit_test(distances_are_to_the_nearest_full_brick),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
