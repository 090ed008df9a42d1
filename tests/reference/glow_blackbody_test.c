// SPDX-License-Identifier: Apache-2.0
#include "reference/glow_blackbody.h"

#include "reference/blackbody.h"
#include "reference/density_grid.h"
#include "reference/integrate.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { WIDTH = 4, HEIGHT = 3, DEPTH = 3, VOXELS = WIDTH * HEIGHT * DEPTH };

static struct grid_params placed(const float *values, double x)
{
    return (struct grid_params){.values = values,
                                .size = {WIDTH, HEIGHT, DEPTH},
                                .index_to_world = {1.0, 0.0, 0.0, x, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0}};
}

static void fill_randomly(float values[static VOXELS], uint64_t seed, double low, double high)
{
    struct random random = {seed};

    for (int i = 0; i < VOXELS; i++)
        values[i] = (float)random_between(&random, low, high);
}

static void glow_is_plancks_light_at_the_grids_temperature(void **state)
{
    float values[VOXELS];
    struct random random = {51};
    struct glow_blackbody field;
    struct medium_glow glow;

    fill_randomly(values, 50, 0.1, 4.0);
    glow_blackbody_init(
        &field, &(struct glow_blackbody_params){.grid = placed(values, 0.0), .kelvin = 1700.0, .intensity = 0.3});
    glow = glow_blackbody(&field);
    for (int i = 0; i < 30; i++) {
        struct vec3 position = {random_between(&random, -0.5, 3.5), random_between(&random, -0.5, 2.5), 1.0};
        double source[3], wanted[3];

        glow.at(glow.field, position, source);
        blackbody_rgb(1700.0 * grid_value(&field.grid, position), wanted);
        // 1e-6 of the brightest channel: far below the accuracy of the integrator.
        for (int c = 0; c < 3; c++)
            assert_near(source[c], 0.3 * wanted[c], 1e-6 * 0.3 * fmax(wanted[0], wanted[1]));
    }
}

static void cold_and_outside_are_dark(void **state)
{
    float values[VOXELS];
    struct glow_blackbody field;
    struct medium_glow glow;
    double source[3];

    fill_randomly(values, 52, 0.1, 0.3);
    glow_blackbody_init(
        &field, &(struct glow_blackbody_params){.grid = placed(values, 0.0), .kelvin = 1000.0, .intensity = 1.0});
    glow = glow_blackbody(&field);
    glow.at(glow.field, (struct vec3){1.0, 1.0, 1.0}, source);
    assert_near(source[0], 0.0, 0.0);
    for (int i = 0; i < VOXELS; i++)
        values[i] = 2.0f;
    glow.at(glow.field, (struct vec3){1.0, 1.0, 1.0}, source);
    assert_true(source[0] > 0.0);
    glow.at(glow.field, (struct vec3){1.0, 1.0, 2.6}, source);
    assert_near(source[0], 0.0, 0.0);
}

// Temperatures have another lattice than the density; the truth is plain sums of a hundred thousand points along 10 m.
static void lattices_that_differ_converge(void **state)
{
    const int count = 100000;
    float densities[VOXELS], temperatures[VOXELS];
    struct density_grid density = {.scale = 0.7};
    struct glow_blackbody field;
    struct grid_params place;
    struct random random = {53};

    fill_randomly(densities, 54, 0.0, 1.0);
    fill_randomly(temperatures, 55, 0.5, 1.5);
    place = placed(densities, 0.0);
    grid_init(&density.grid, &place);
    glow_blackbody_init(
        &field, &(struct glow_blackbody_params){.grid = placed(temperatures, 0.3), .kelvin = 2000.0, .intensity = 1.0});
    for (int n = 0; n < 5; n++) {
        struct vec3 target = {random_between(&random, 0.0, 3.0), random_between(&random, 0.0, 2.0), 1.0};
        struct vec3 origin = {-3.0, random_between(&random, 0.0, 2.0), random_between(&random, 0.0, 2.0)};
        struct ray ray = {origin, vec3_normalize(vec3_subtract(target, origin))};
        struct still still = {.medium_count = 1};
        struct integrate_result result;
        double share = 1.0, radiance[3] = {0.0, 0.0, 0.0};

        still.media[0].density = density_grid(&density);
        still.media[0].glow = glow_blackbody(&field);
        for (int c = 0; c < 3; c++)
            still.media[0].sigma_a[c] = 1.0;
        result = integrate_ray(&still, &ray, 0.0, INFINITY, NULL);
        for (int i = 0; i < count; i++) {
            double step = 10.0 / count, rho;
            struct vec3 position = ray_at(&ray, (i + 0.5) * step);
            double source[3];

            rho = still.media[0].density.at(&density, position);
            medium_source(&still.media[0], position, rho, source);
            for (int c = 0; c < 3; c++)
                radiance[c] += source[c] * share * exp(-0.5 * rho * step) * step;
            share *= exp(-rho * step);
        }
        assert_true(result.is_converged && radiance[0] > 0.1);
        // 1e-4 is promised; the sums are off by up to half a step of 1e-4 where the grids jump at their faces.
        for (int c = 0; c < 3; c++)
            assert_near(result.radiance[c], radiance[c], 2e-4 * radiance[0]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glow_is_plancks_light_at_the_grids_temperature),
        cmocka_unit_test(cold_and_outside_are_dark),
        cmocka_unit_test(lattices_that_differ_converge),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
