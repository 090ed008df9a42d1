// SPDX-License-Identifier: Apache-2.0
#include "reference/transmittance.h"

#include "reference/closed_form.h"
#include "reference/still.h"
#include "tests/support/assert_near.h"
#include "tests/support/homogeneous.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void assert_passes(struct density density, double sigma_t, struct ray ray, double length)
{
    struct medium medium = {.density = density, .sigma_a = {sigma_t, 0.5 * sigma_t, 0.0}};
    double share[3];

    transmittance(&medium, 1, &ray, 0.0, INFINITY, 1e-9, share);
    // 1e-12: a constant is integrated exactly except for roundings.
    assert_near(share[0], closed_form_transmittance(sigma_t, length), 1e-12);
    assert_near(share[1], closed_form_transmittance(0.5 * sigma_t, length), 1e-12);
    assert_near(share[2], 1.0, 0.0);
}

static void sphere_passes_by_its_chord(void **state)
{
    struct homogeneous_sphere sphere = {1.5};

    for (double offset = 0.0; offset < 2.0; offset += 0.25) {
        struct ray ray = {{offset, 0.0, -5.0}, {0.0, 0.0, 1.0}};

        assert_passes(homogeneous_sphere_density(&sphere), 0.7, ray, closed_form_sphere_chord(1.5, offset));
    }
}

static void slab_passes_by_its_slant(void **state)
{
    struct homogeneous_box slab = {INFINITY, INFINITY, 0.4};

    for (double angle = -1.4; angle < 1.5; angle += 0.4) {
        struct ray ray = {{0.0, 3.0, -5.0}, {sin(angle), 0.0, cos(angle)}};

        assert_passes(homogeneous_box_density(&slab), 2.0, ray, closed_form_slab_length(0.8, cos(angle)));
    }
}

static void box_passes_by_its_diagonal(void **state)
{
    struct homogeneous_box box = {1.0, 1.0, 1.0};
    struct ray ray = {{-4.0, -4.0, -4.0}, {1.0 / sqrt(3.0), 1.0 / sqrt(3.0), 1.0 / sqrt(3.0)}};

    assert_passes(homogeneous_box_density(&box), 0.3, ray, 2.0 * sqrt(3.0));
}

static void rays_end_at_the_given_distance(void **state)
{
    struct homogeneous_box slab = {INFINITY, INFINITY, 1.0};
    struct medium medium = {.density = homogeneous_box_density(&slab), .sigma_s = {1.0, 1.0, 1.0}};
    struct ray ray = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
    double share[3];

    transmittance(&medium, 1, &ray, 0.25, 0.75, 1e-9, share);
    assert_near(share[0], exp(-0.5), 1e-12);
}

static void media_and_both_coefficients_attenuate(void **state)
{
    struct homogeneous_box slab = {INFINITY, INFINITY, 0.5};
    struct homogeneous_sphere sphere = {0.25};
    struct medium media[] = {
        {.density = homogeneous_box_density(&slab), .sigma_s = {1.0, 2.0, 3.0}, .sigma_a = {0.5, 0.0, 0.0}},
        {.density = homogeneous_sphere_density(&sphere), .sigma_s = {0.0, 1.0, 0.0}, .sigma_a = {4.0, 0.0, 0.0}},
    };
    struct ray ray = {{0.0, 0.0, -2.0}, {0.0, 0.0, 1.0}};
    double share[3];

    transmittance(media, 2, &ray, 0.0, INFINITY, 1e-9, share);
    assert_near(share[0], exp(-1.5 - 2.0), 1e-12);
    assert_near(share[1], exp(-2.0 - 0.5), 1e-12);
    assert_near(share[2], exp(-3.0), 1e-12);
}

// The folds without an offset are isometries that keep the origin: density falls from the centre like a cone.
static void fractal_without_offset_is_a_cone(void **state)
{
    static const double OFFSETS[] = {0.0, 1e-6, 0.05, 0.3, 0.6, 0.79, 0.81};

    for (int exponent = 1; exponent <= 2; exponent++) {
        struct density_fold_fractal fractal;

        density_fold_fractal_init(&fractal, &(struct density_fold_fractal_params){.iterations = 5,
                                                                                  .radius = 0.8,
                                                                                  .exponent = exponent,
                                                                                  .scale = 3.0,
                                                                                  .rotate_x_rad = 0.7,
                                                                                  .rotate_y_rad = -1.1});
        for (size_t i = 0; i < sizeof OFFSETS / sizeof OFFSETS[0]; i++) {
            struct density density = still_fractal_density(&fractal);
            struct ray ray = {{OFFSETS[i] * 0.6, OFFSETS[i] * 0.8, -2.0}, {0.0, 0.0, 1.0}};
            double wanted = 3.0 * closed_form_cone_column(0.8, OFFSETS[i], exponent);

            assert_near(transmittance_density_column(&density, &ray, 0.0, INFINITY, 1e-8), wanted, 1e-8);
        }
    }
}

static void column_meets_its_tolerance_at_an_odd_exponent(void **state)
{
    static const double EXPONENTS[] = {0.5, 1.3, 3.7};

    for (int i = 0; i < 3; i++) {
        struct density_fold_fractal fractal;
        struct density density = still_fractal_density(&fractal);
        struct ray ray = {{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};

        density_fold_fractal_init(&fractal,
                                  &(struct density_fold_fractal_params){
                                      .iterations = 1, .radius = 0.5, .exponent = EXPONENTS[i], .scale = 10.0});
        // The integral is twice that of 10 x^e over [0, 0.5].
        assert_near(transmittance_density_column(&density, &ray, 0.0, INFINITY, 1e-7),
                    20.0 * pow(0.5, EXPONENTS[i] + 1.0) / (EXPONENTS[i] + 1.0), 1e-7);
    }
}

// Sums by the midpoint rule with a hundred thousand points.
static double summed_column(const struct density *density, const struct ray *ray, double far)
{
    const int count = 100000;
    double sum = 0.0;

    for (int i = 0; i < count; i++)
        sum += density->at(density->field, ray_at(ray, (i + 0.5) * far / count));
    return sum * far / count;
}

static void assert_noise_columns(struct density_noise_params params, double asked, double tolerance)
{
    struct random random = {77};
    struct density_noise noise;
    struct density_bounded bounded = {.bounds = {.kind = SCENE_BOUNDS_SPHERE, .radius = 1.0, .falloff = 0.3}};
    struct density density;

    params.frequency = 3.0;
    params.lacunarity = 2.0;
    params.hurst = 1.0;
    params.axis.y = 1.0;
    params.scale = 4.0;
    density_noise_init(&noise, &params);
    bounded.inner = density_noise_field(&noise);
    density = density_bounded(&bounded);
    for (int i = 0; i < 60; i++) {
        struct vec3 start, way, light = {2.0, 2.0, 2.0};
        struct ray ray;
        double far;

        start.x = random_between(&random, -1.0, 1.0);
        start.y = random_between(&random, -1.0, 1.0);
        start.z = random_between(&random, -1.0, 1.0);
        way = vec3_subtract(light, start);
        far = vec3_length(way);
        ray = (struct ray){start, vec3_normalize(way)};
        assert_near(transmittance_density_column(&density, &ray, 0.0, far, asked), summed_column(&density, &ray, far),
                    tolerance);
    }
}

// The nodes of few cells agree by accident more often than expected.
static void smooth_noise_meets_its_tolerance(void **state)
{
    assert_noise_columns((struct density_noise_params){.octaves = 4, .mode = SCENE_NOISE_REMAP}, 1e-6, 1e-6);
}

// The bumps are isolated between zeros, and rise like a root. 5e-6: bumps within 5 mm, an eighth of the finest cell,
// may be missed.
static void clipped_noise_misses_no_bump(void **state)
{
    assert_noise_columns((struct density_noise_params){.octaves = 3, .mode = SCENE_NOISE_CLIP, .bias = 0.2}, 1e-6,
                         5e-6);
}

// Every octave has kinks, none of them at an end of a span: the error is up to four times what is asked for.
static void turbulence_is_near_its_tolerance(void **state)
{
    assert_noise_columns((struct density_noise_params){.octaves = 4, .mode = SCENE_NOISE_ABSOLUTE}, 1e-5, 4e-5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_passes_by_its_chord),
        cmocka_unit_test(slab_passes_by_its_slant),
        cmocka_unit_test(box_passes_by_its_diagonal),
        cmocka_unit_test(rays_end_at_the_given_distance),
        cmocka_unit_test(media_and_both_coefficients_attenuate),
        cmocka_unit_test(fractal_without_offset_is_a_cone),
        cmocka_unit_test(column_meets_its_tolerance_at_an_odd_exponent),
        cmocka_unit_test(smooth_noise_meets_its_tolerance),
        cmocka_unit_test(clipped_noise_misses_no_bump),
        cmocka_unit_test(turbulence_is_near_its_tolerance),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
