// SPDX-License-Identifier: Apache-2.0
#include "reference/majorant.h"

#include "reference/still.h"
#include "tests/support/assert_near.h"
#include "tests/support/path_still.h"
#include "tests/support/random.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { POINTS = 100 * 1000, RAYS = 200 };

static struct vec3 random_vector(struct random *random, double half)
{
    double x = random_between(random, -half, half), y = random_between(random, -half, half);

    return (struct vec3){x, y, random_between(random, -half, half)};
}

// No density exceeds its bound, and the bounds are worth having: on average at most `slack` times the densities.
static void check(const struct density *density, double half, double slack)
{
    struct random random = {3};
    struct majorant majorant;
    double densities = 0.0, bounds = 0.0;

    assert_true(majorant_init(&majorant, density));
    for (int i = 0; i < POINTS; i++) {
        struct vec3 point = random_vector(&random, half);
        double value = density->at(density->field, point), bound = majorant_at(&majorant, point);

        assert_true(value <= bound);
        assert_true(bound <= majorant.most);
        densities += value;
        bounds += bound;
    }
    print_message("bounds are %.2f times the densities\n", bounds / densities);
    assert_true(densities > 0.0 && bounds <= slack * densities);
    majorant_finish(&majorant);
}

static void no_fold_exceeds_its_bound(void **state)
{
    struct still still;

    solid_still_init(&still);
    check(&path_still_add_fold(&still, 1.0, 0.0)->density, 3.0, 2.5);
}

static void no_noise_exceeds_its_bound(void **state)
{
    static const enum scene_noise_mode MODES[] = {SCENE_NOISE_REMAP, SCENE_NOISE_CLIP, SCENE_NOISE_ABSOLUTE};

    for (size_t i = 0; i < 3; i++) {
        struct still still;

        solid_still_init(&still);
        check(&path_still_add_noise(&still, MODES[i], 1.0, 0.0)->density, 1.0, 12.0);
    }
}

static void no_endless_noise_exceeds_its_bound(void **state)
{
    struct density_noise noise;
    struct density density;

    density_noise_init(&noise, &(struct density_noise_params){.octaves = 1,
                                                              .mode = SCENE_NOISE_ABSOLUTE,
                                                              .frequency = 1.0,
                                                              .lacunarity = 2.0,
                                                              .axis = {0.0, 0.0, 1.0},
                                                              .scale = 1.0});
    density = density_noise_field(&noise);
    check(&density, 100.0, 8.0);
}

// The slope and the greatest value of an octave are what the bounds of noise stand on.
static void octaves_are_no_steeper_than_their_bound(void **state)
{
    const double step = 1e-5;
    struct random random = {9};
    double steepest = 0.0, greatest = 0.0;

    for (int i = 0; i < 10 * POINTS; i++) {
        struct vec3 point = random_vector(&random, 128.0), other = random_vector(&random, 1.0);
        double value = density_noise_octave(point);
        struct vec3 way = vec3_scale(vec3_normalize(other), step);

        greatest = fmax(greatest, fabs(value));
        steepest = fmax(steepest, fabs(density_noise_octave(vec3_add(point, way)) - value) / step);
    }
    print_message("steepest %.3f, greatest %.3f\n", steepest, greatest);
    assert_true(steepest <= 4.0 && greatest <= 1.037);
    assert_true(steepest > 2.0 && greatest > 0.8);
}

static void no_voxel_exceeds_its_bound(void **state)
{
    for (int is_nearest = 0; is_nearest < 2; is_nearest++) {
        struct still still;
        struct medium *medium;

        solid_still_init(&still);
        medium = path_still_add_grid(&still, 1.0, 0.0);
        still.fields[0].grid.grid.is_nearest = is_nearest;
        check(&medium->density, 1.5, 5.0);
    }
}

static void no_transfer_function_exceeds_its_bound(void **state)
{
    static const struct scene_transfer_point POINTS_OF_IT[] = {
        {-0.5, {1.0, 1.0, 1.0, 0.0}}, {0.2, {1.0, 1.0, 1.0, 0.9}}, {0.4, {1.0, 1.0, 1.0, 0.1}}};
    struct still still;
    struct density density;

    solid_still_init(&still);
    path_still_add_grid(&still, 1.0, 0.0);
    still.fields[0].grid.has_transfer = true;
    still.fields[0].grid.transfer =
        (struct transfer_function){.points = POINTS_OF_IT, .count = 3, .unit_distance = 0.7};
    density = density_grid(&still.fields[0].grid);
    check(&density, 1.5, 8.0);
}

static void balls_and_boxes_are_their_own_bounds(void **state)
{
    struct still still;

    solid_still_init(&still);
    check(&path_still_add_ball(&still, (struct vec3){0.5, -0.2, 0.1}, 1.2, 1.0, 0.0)->density, 2.0, 2.0);
    check(&path_still_add_box(&still, (struct vec3){0.5, 1.0, 2.0}, 1.0, 0.0)->density, 2.0, 1.001);
}

static void a_density_without_a_bound_is_refused(void **state)
{
    struct density_function function = {.scale = 1.0};
    struct density density = density_function(&function);
    struct majorant majorant;

    assert_false(majorant_init(&majorant, &density));
    majorant_finish(&majorant);
}

// 4000 points a stretch see the bound's jumps at bricks within some thousandths.
static double summed_bound(const struct majorant *majorant, const struct ray *ray, double near, double far)
{
    const int pieces = 4000;
    double sum = 0.0;

    for (int i = 0; i < pieces; i++)
        sum += majorant_at(majorant, ray_at(ray, near + (far - near) * (i + 0.5) / pieces));
    return sum * (far - near) / pieces;
}

static void flights_go_as_far_as_the_bound_says(void **state)
{
    struct random random = {11};
    struct majorant majorant;
    struct still still;
    int arrived = 0;

    solid_still_init(&still);
    assert_true(majorant_init(&majorant, &path_still_add_grid(&still, 1.0, 0.0)->density));
    for (int i = 0; i < RAYS; i++) {
        struct ray ray = {random_vector(&random, 2.0), vec3_normalize(random_vector(&random, 1.0))};
        double near = random_between(&random, 0.0, 0.5), column = random_between(&random, 0.0, 3.0), whole, at;
        struct flight flight;

        if (i % 8 == 0) ray.direction = (struct vec3){0.0, i % 16 == 0 ? 1.0 : -1.0, 0.0};
        flight_begin(&flight, &majorant, &ray, near, 4.0);
        whole = flight_column(&flight);
        assert_near(summed_bound(&majorant, &ray, near, 4.0), whole, 0.01 * whole + 0.02);
        at = flight_advance(&flight, 0.3 * column);
        if (!isinf(at)) assert_near(flight_column(&flight), whole - 0.3 * column, 1e-9);
        if (!isinf(at)) at = flight_advance(&flight, 0.7 * column);
        if (isinf(at)) {
            assert_true(summed_bound(&majorant, &ray, near, 4.0) <= column * 1.02 + 0.02);
        } else {
            assert_near(summed_bound(&majorant, &ray, near, at), column, 0.01 * column + 0.02);
            arrived++;
        }
    }
    assert_true(arrived > RAYS / 8);
    majorant_finish(&majorant);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_fold_exceeds_its_bound),
        cmocka_unit_test(no_noise_exceeds_its_bound),
        cmocka_unit_test(no_endless_noise_exceeds_its_bound),
        cmocka_unit_test(octaves_are_no_steeper_than_their_bound),
        cmocka_unit_test(no_voxel_exceeds_its_bound),
        cmocka_unit_test(no_transfer_function_exceeds_its_bound),
        cmocka_unit_test(balls_and_boxes_are_their_own_bounds),
        cmocka_unit_test(a_density_without_a_bound_is_refused),
        cmocka_unit_test(flights_go_as_far_as_the_bound_says),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
