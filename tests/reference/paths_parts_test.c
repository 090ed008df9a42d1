// Light in two parts: what is scattered at most so often, and the rest.
// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.h"
#include "reference/paths.h"
#include "tests/support/assert_near.h"
#include "tests/support/path_still.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { PATHS = 1 << 13, SEED = 11 };

static struct paths_parts measure(const struct still *still, int orders, int modelled, long count)
{
    struct paths *paths = paths_create(still, orders, NULL);
    struct paths_parts parts;

    assert_non_null(paths);
    assert_true(paths_measure_parts(
        paths, &(struct paths_parts_params){.x = 2.5, .y = 2.5, .modelled = modelled, .count = count, .seed = SEED},
        &parts));
    paths_destroy(paths);
    return parts;
}

// All that light can come from: lamps near and far, a lamp with size, a dome, a medium that glows, a floor.
static void init_all(struct still *still)
{
    const struct material material = solid_diffuse(0.6);
    struct shape floor = solid_plane((struct vec3){0.0, -1.0, 0.0}, (struct vec3){0.0, 1.0, 0.3});
    struct medium *ball;

    solid_still_init(still);
    solid_still_set_background(still, 0.3);
    solid_still_add(still, &material, &floor, 1);
    ball = path_still_add_ball(still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.7, 0.2);
    path_still_set_g(ball, 0.5);
    for (int c = 0; c < 3; c++) {
        ball->emission[c] = 0.2 + 0.1 * c;
        ball->sigma_s[c] *= 1.0 + 0.2 * c;
    }
    path_still_add_point(still, (struct vec3){0.2, 0.1, 0.1}, 2.0);
    path_still_add_sun(still, (struct vec3){0.3, -1.0, -0.5}, 1.5);
    path_still_set_dome(still, 0.8);
    still->spheres[still->sphere_count++] =
        (struct sphere_light){.center = {0.0, 2.0, 0.5}, .radius = 0.9, .radiance = {9.0, 7.0, 5.0}};
}

// The orders of an endless medium that glows and scatters are a geometric series: emission over extinction, times the
// albedo for each scattering.
static void orders_of_an_endless_glow_are_a_geometric_series(void **state)
{
    const double albedo = 0.6, sigma_t = 0.5, emission = 2.0, whole = emission / (sigma_t * (1.0 - albedo));
    struct still still;
    struct medium *medium;

    solid_still_init(&still);
    medium = solid_still_fill(&still, 0, sigma_t * albedo, sigma_t * (1.0 - albedo));
    for (int c = 0; c < 3; c++)
        medium->emission[c] = emission;
    for (int modelled = 1; modelled <= 4; modelled++) {
        struct paths_parts parts = measure(&still, SCENE_ORDERS_ALL, modelled, 1 << 16);
        double beyond = whole * pow(albedo, modelled);

        assert_near(parts.within[1], whole - beyond, 0.015 * whole);
        assert_near(parts.beyond[1], beyond, 0.015 * whole);
    }
}

// The same draws: what is parted adds up to what is not, but for rounding.
static void the_parts_are_the_whole(void **state)
{
    struct paths_light whole;
    struct still still;

    init_all(&still);
    assert_true(paths_measure_pixel(&still, SCENE_ORDERS_ALL, 2, 2, PATHS, SEED, &whole));
    for (int modelled = 1; modelled <= 3; modelled++) {
        struct paths_parts parts = measure(&still, SCENE_ORDERS_ALL, modelled, PATHS);

        for (int c = 0; c < 3; c++) {
            assert_true(parts.within[c] > 0.0 && parts.beyond[c] > 0.0);
            assert_near(parts.within[c] + parts.beyond[c], whole.mean[c], 1e-9 * whole.mean[c]);
        }
        assert_true(parts.draws > PATHS);
    }
}

// Paths that end after so many scatterings are another measurement of the one part.
static void a_part_is_the_light_of_so_many_orders(void **state)
{
    struct still still;

    init_all(&still);
    for (int modelled = 1; modelled <= 3; modelled++) {
        struct paths_parts parts = measure(&still, SCENE_ORDERS_ALL, modelled, 4 * PATHS);
        struct paths_light ended;

        assert_true(paths_measure_pixel(&still, modelled, 2, 2, 4 * PATHS, SEED + 1, &ended));
        for (int c = 0; c < 3; c++)
            assert_by_chance(parts.within[c], M_SQRT2 * ended.error[c], ended.mean[c], 0.02, 0.0);
    }
}

static void a_part_of_all_orders_leaves_nothing(void **state)
{
    struct paths_parts parts;
    struct still still;

    init_all(&still);
    parts = measure(&still, 3, 3, 64);
    for (int c = 0; c < 3; c++)
        assert_true(parts.beyond[c] == 0.0);
}

// A path that would go on for long is given up.
static void a_limit_on_the_draws_is_kept(void **state)
{
    const struct paths_parts_params params = {.x = 2.5, .y = 2.5, .modelled = 1, .count = 4, .draws_most = 1e4};
    struct paths_parts parts;
    struct paths *paths;
    struct still still;

    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 3000.0, 0.0);
    path_still_set_dome(&still, 1.0);
    paths = paths_create(&still, SCENE_ORDERS_ALL, NULL);
    assert_false(paths_measure_parts(paths, &params, &parts));
    assert_true(parts.draws > 1e4 && parts.draws < 1.1e4);
    paths_destroy(paths);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orders_of_an_endless_glow_are_a_geometric_series),
        cmocka_unit_test(the_parts_are_the_whole),
        cmocka_unit_test(a_part_is_the_light_of_so_many_orders),
        cmocka_unit_test(a_part_of_all_orders_leaves_nothing),
        cmocka_unit_test(a_limit_on_the_draws_is_kept),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
