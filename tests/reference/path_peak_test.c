// SPDX-License-Identifier: Apache-2.0
#include "reference/path_peak.h"

#include "reference/path_walk.h"
#include "tests/support/path_still.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// The mean of paths along rays that pass the origin at 0.15 m, and its standard error.
struct look {
    double mean, error;
};

static struct look look_beside(const struct path_scene *scene, int count, uint64_t seed)
{
    double mean = 0.0, squares = 0.0;

    for (int i = 0; i < count; i++) {
        struct path_walk walk = {.ray = {{0.15, 0.0, 3.0}, {0.0, 0.0, -1.0}}, .far = INFINITY, .is_seen = true};
        struct stream stream = stream_of(seed, (uint64_t)i);
        double radiance[3] = {0.0, 0.0, 0.0}, off;

        path_walk_force(scene, &walk);
        path_walk_add(scene, &walk, &stream, radiance);
        off = radiance[0] - mean;
        mean += off / (i + 1);
        squares += off * (radiance[0] - mean);
    }
    return (struct look){mean, sqrt(squares / ((double)count * (count - 1)))};
}

// A lamp in a ball of forward and backward lobes: a point, or a sphere. `side`: 1, or -1 for lobes the other way round.
static void fill_ball(struct still *still, int lamp, double side)
{
    struct medium *medium;

    solid_still_init(still);
    medium = path_still_add_ball(still, (struct vec3){0.1, 0.1, 0.0}, 0.9, 2.0, 0.3);
    medium->lobes[0] = (struct medium_lobe){SCENE_LOBE_HENYEY_GREENSTEIN, 0.7 * side, 0.8};
    medium->lobes[1] = (struct medium_lobe){SCENE_LOBE_HENYEY_GREENSTEIN, -0.3 * side, 0.2};
    medium->lobe_count = 2;
    if (lamp == 0) path_still_add_point(still, (struct vec3){0.0, 0.0, 0.0}, 1.0);
    if (lamp == 1)
        still->spheres[still->sphere_count++] =
            (struct sphere_light){.center = {0.0, 0.0, 0.0}, .radius = 0.03, .radiance = {300.0, 300.0, 300.0}};
}

// Connections that follow lobes, those of second paths, and paths that end early bring what plain paths do.
static void lobes_change_no_light_near_lamps(void **state)
{
    static const int ORDERS[] = {1, 2, SCENE_ORDERS_ALL, 2, SCENE_ORDERS_ALL};

    for (int lamp = 0; lamp < 2; lamp++)
        for (size_t k = 0; k < 5; k++) {
            double side = k < 3 ? 1.0 : -1.0;
            struct look by_lobes, plain;
            struct path_scene scene;
            struct still still;

            fill_ball(&still, lamp, side);
            path_scene_init(&scene, &still, ORDERS[k]);
            assert_ptr_equal(scene.narrow, &scene.media[0]);
            scene.media[0].aim_vertices = 3;
            by_lobes = look_beside(&scene, 60000, 1);
            scene.narrow = NULL;
            scene.media[0].aim_vertices = 0;
            scene.media[0].turn = 0.0;
            plain = look_beside(&scene, 120000, 2);
            path_scene_finish(&scene);
            print_message("lamp %d, side %g, %d orders: %.5f +- %.5f, plain %.5f +- %.5f\n", lamp, side, ORDERS[k],
                          by_lobes.mean, by_lobes.error, plain.mean, plain.error);
            // Noise of lobes that turn back is larger: few paths have most of the light.
            assert_by_chance(by_lobes.mean, hypot(by_lobes.error, plain.error), plain.mean, k < 3 ? 0.012 : 0.02, 0.0);
        }
}

// Deep in a medium second paths for a lamp are sent seldom or not at all, and paths end early.
static void depth_changes_no_light(void **state)
{
    for (int i = 0; i < 3; i++) {
        double sigma_t = i == 0 ? 12.0 : 40.0;
        struct look deep, plain;
        struct path_scene scene;
        struct still still;

        solid_still_init(&still);
        if (i < 2)
            path_still_set_g(path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, sigma_t, 0.0), 0.85);
        else
            path_still_set_g(path_still_add_noise(&still, SCENE_NOISE_CLIP, sigma_t, 0.0), 0.85);
        path_still_add_sun(&still, (struct vec3){1.0, -1.0, -0.3}, 1.0);
        path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
        deep = look_beside(&scene, 40000, 3);
        scene.media[0].aim_vertices = 0;
        scene.media[0].turn = 0.0;
        plain = look_beside(&scene, 40000, 4);
        path_scene_finish(&scene);
        print_message("%d, %.0f a metre: %.5f +- %.5f, plain %.5f +- %.5f\n", i, sigma_t, deep.mean, deep.error,
                      plain.mean, plain.error);
        assert_by_chance(deep.mean, hypot(deep.error, plain.error), plain.mean, 0.03, 0.0);
    }
}

static void only_lobes_that_are_narrow_are_followed(void **state)
{
    static const double G[] = {-0.9, -0.2, 0.0, 0.2, 0.4, 0.9};

    for (size_t i = 0; i < sizeof G / sizeof G[0]; i++) {
        struct path_scene scene;
        struct still still;

        solid_still_init(&still);
        path_still_set_g(path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.0, 0.1), G[i]);
        path_scene_init(&scene, &still, 2);
        assert_int_equal(scene.narrow != NULL, fabs(G[i]) > 0.3);
        path_scene_finish(&scene);
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lobes_change_no_light_near_lamps),
        cmocka_unit_test(depth_changes_no_light),
        cmocka_unit_test(only_lobes_that_are_narrow_are_followed),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
