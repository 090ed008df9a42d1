// SPDX-License-Identifier: Apache-2.0
#include "reference/density_fold_fractal.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include <cmocka.h>

static const struct density_fold_fractal_params CLOUD = {
    .iterations = 8,
    .offset = 0.06,
    .radius = 0.15,
    .exponent = 1.3,
    .scale = 10.0,
    .rotate_x_rad = -0.4,
    .rotate_y_rad = -0.2,
};

static struct vec3 random_point(struct random *random, double half_size)
{
    struct vec3 point;

    point.x = random_between(random, -half_size, half_size);
    point.y = random_between(random, -half_size, half_size);
    point.z = random_between(random, -half_size, half_size);
    return point;
}

static void one_iteration_rotates_folds_and_shifts_as_documented(void **state)
{
    struct density_fold_fractal fractal;
    struct density_fold_fractal_params params = {.iterations = 1,
                                                 .offset = 0.06,
                                                 .radius = 2.0,
                                                 .exponent = 1.0,
                                                 .scale = 3.0,
                                                 .rotate_x_rad = M_PI / 2.0,
                                                 .rotate_y_rad = M_PI / 2.0};
    // Rotation about x: (1, 2, 3) -> (1, -3, 2); about y: -> (2, -3, -1). Folds: x + y = -1 -> (3, -2, -1); y + z = -3
    // -> (3, 1, 2); z + x = 5 stays.
    struct vec3 image = {2.94, 0.94, 1.94};

    density_fold_fractal_init(&fractal, &params);
    assert_near(density_fold_fractal_distance(&fractal, (struct vec3){1.0, 2.0, 3.0}), vec3_length(image) - 2.0,
                1e-14); // a few roundings
    assert_near(density_fold_fractal(&fractal, (struct vec3){0.0, 0.0, 0.0}), 3.0 * (2.0 - 0.06 * sqrt(3.0)), 1e-14);
}

static void density_is_scaled_depth_to_the_power(void **state)
{
    struct density_fold_fractal fractal;
    struct random random = {1};
    int inside = 0;

    density_fold_fractal_init(&fractal, &CLOUD);
    for (int i = 0; i < 2000; i++) {
        struct vec3 point = random_point(&random, 0.6);
        double depth = -density_fold_fractal_distance(&fractal, point);
        double density = density_fold_fractal(&fractal, point);

        if (depth <= 0.0) {
            assert_true(density == 0.0);
            continue;
        }
        inside++;
        assert_near(log(density), log(10.0) + 1.3 * log(depth), 1e-12); // roundings of two logarithms
    }
    assert_true(inside > 100);
}

static void distance_changes_no_faster_than_the_point(void **state)
{
    struct random random = {2};

    for (int i = 0; i < 2000; i++) {
        struct density_fold_fractal fractal;
        struct density_fold_fractal_params params = CLOUD;
        struct vec3 a = random_point(&random, 1.0), b = vec3_add(a, random_point(&random, i % 2 ? 0.01 : 1.0));

        params.rotate_x_rad = random_between(&random, -3.0, 3.0);
        params.rotate_y_rad = random_between(&random, -3.0, 3.0);
        density_fold_fractal_init(&fractal, &params);
        // 1e-14: the roundings of 24 folds.
        assert_true(fabs(density_fold_fractal_distance(&fractal, a) - density_fold_fractal_distance(&fractal, b)) <=
                    vec3_length(vec3_subtract(a, b)) + 1e-14);
    }
}

static void density_is_zero_outside_the_bound(void **state)
{
    struct random random = {3};

    for (int i = 0; i < 2000; i++) {
        struct density_fold_fractal fractal;
        struct density_fold_fractal_params params = CLOUD;
        struct vec3 direction;

        params.rotate_x_rad = random_between(&random, -3.0, 3.0);
        params.rotate_y_rad = random_between(&random, -3.0, 3.0);
        density_fold_fractal_init(&fractal, &params);
        direction = vec3_normalize(random_point(&random, 1.0));
        assert_true(density_fold_fractal(
                        &fractal, vec3_scale(direction, density_fold_fractal_bound(&fractal) * (1.0 + 1e-12))) == 0.0);
    }
}

// One iteration without rotation maps (1, 1, 1) k to (k - offset) (1, 1, 1), where the bound is attained.
static void bound_is_no_larger_than_needed(void **state)
{
    struct density_fold_fractal fractal;
    struct density_fold_fractal_params params = CLOUD;
    double bound;

    params.rotate_x_rad = params.rotate_y_rad = 0.0;
    density_fold_fractal_init(&fractal, &params);
    bound = density_fold_fractal_bound(&fractal);
    assert_near(bound, 0.15 + 8.0 * sqrt(3.0) * 0.06, 1e-14);
    assert_true(density_fold_fractal(&fractal, vec3_scale((struct vec3){1.0, 1.0, 1.0}, 0.999 * bound / sqrt(3.0))) >
                0.0);
}

static bool is_covered(const struct span_list *spans, double distance)
{
    for (size_t i = 0; i < spans->count; i++) {
        if (spans->spans[i].begin <= distance && distance <= spans->spans[i].end) return true;
    }
    return false;
}

static void spans_hold_all_density_and_nothing_else(void **state)
{
    struct density_fold_fractal fractal;
    struct random random = {4};
    int positive = 0;

    density_fold_fractal_init(&fractal, &CLOUD);
    for (int i = 0; i < 500; i++) {
        struct vec3 origin = random_point(&random, 1.2), target = random_point(&random, 0.4);
        struct ray ray = {origin, vec3_normalize(vec3_subtract(target, origin))};
        struct span_list spans = {0};

        density_fold_fractal_spans(&fractal, &ray, 0.0, INFINITY, &spans);
        for (int k = 0; k < 200; k++) {
            double distance = random_between(&random, 0.0, 3.0);
            double inside = -density_fold_fractal_distance(&fractal, ray_at(&ray, distance));

            // 1e-9: both may round to different sides nearer to the surface.
            if (inside > 1e-9) assert_true(is_covered(&spans, distance));
            if (inside < -1e-9) assert_false(is_covered(&spans, distance));
            positive += inside > 0.0;
        }
        span_list_finish(&spans);
    }
    assert_true(positive > 1000);
}

static void spans_ascend_and_their_images_give_the_density(void **state)
{
    struct density_fold_fractal fractal;
    struct random random = {5};

    density_fold_fractal_init(&fractal, &CLOUD);
    for (int i = 0; i < 300; i++) {
        struct vec3 origin = random_point(&random, 1.2), target = random_point(&random, 0.4);
        struct ray ray = {origin, vec3_normalize(vec3_subtract(target, origin))};
        struct span_list spans = {0};

        density_fold_fractal_spans(&fractal, &ray, 0.1, 2.0, &spans);
        for (size_t k = 0; k < spans.count; k++) {
            const struct span *span = &spans.spans[k];
            double distance = random_between(&random, span->begin, span->end);

            assert_true(span->begin < span->end && span->begin >= 0.1 && span->end <= 2.0);
            if (k > 0) assert_true(span[-1].end <= span->begin);
            // 1e-12: the slope of the density, 10 * 1.3 * 0.15^0.3, times the roundings of 24 folds.
            assert_near(density_fold_fractal_folded(&fractal, ray_at(&span->image, distance)),
                        density_fold_fractal(&fractal, ray_at(&ray, distance)), 1e-12);
        }
        span_list_finish(&spans);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_iteration_rotates_folds_and_shifts_as_documented),
        cmocka_unit_test(density_is_scaled_depth_to_the_power),
        cmocka_unit_test(distance_changes_no_faster_than_the_point),
        cmocka_unit_test(density_is_zero_outside_the_bound),
        cmocka_unit_test(bound_is_no_larger_than_needed),
        cmocka_unit_test(spans_hold_all_density_and_nothing_else),
        cmocka_unit_test(spans_ascend_and_their_images_give_the_density),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
