// SPDX-License-Identifier: Apache-2.0
#include "reference/path_aim.h"

#include "reference/path_walk.h"
#include "tests/support/path_still.h"
#include "tests/support/solid_still.h"
#include "tests/support/tally.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// Narrow lobes in two media of which one has a second lobe, above a floor; a sun, a sphere and a point, by turns.
// `side`: 1 for lobes ahead, -1 for lobes that turn back.
static void fill_narrow_media(struct still *still, int lamp, double side)
{
    const struct material matt = solid_diffuse(0.7);
    struct shape floor = solid_plane((struct vec3){0.0, -0.8, 0.0}, (struct vec3){0.0, 1.0, 0.0});
    struct medium *medium;

    solid_still_init(still);
    solid_still_add(still, &matt, &floor, 1);
    path_still_set_g(path_still_add_grid(still, 2.0, 0.3), 0.9 * side);
    medium = path_still_add_ball(still, (struct vec3){0.4, 0.2, 0.0}, 0.8, 3.0, 0.2);
    medium->lobes[0] = (struct medium_lobe){SCENE_LOBE_HENYEY_GREENSTEIN, 0.95 * side, 0.8};
    medium->lobes[1] = (struct medium_lobe){SCENE_LOBE_HENYEY_GREENSTEIN, -0.5 * side, 0.2};
    medium->lobe_count = 2;
    if (lamp == 0) path_still_add_sun(still, (struct vec3){0.3, -0.8, -0.5}, 1.0);
    if (lamp == 1)
        still->spheres[still->sphere_count++] =
            (struct sphere_light){.center = {0.2, 2.0, 1.0}, .radius = 0.5, .radiance = {1.0, 1.0, 1.0}};
    if (lamp == 2) path_still_add_point(still, (struct vec3){0.1, 1.5, -1.5}, 3.0);
}

static struct tally look_through(const struct path_scene *scene, int count, uint64_t seed)
{
    struct tally tally = {0};

    for (uint64_t i = 0; i < (uint64_t)count; i++) {
        struct path_walk walk = {.ray = {{0.2, 0.1, 3.0}, {0.0, -0.05, -1.0}}, .far = INFINITY, .is_seen = true};
        struct stream stream = stream_of(seed, i);
        double radiance[3] = {0.0, 0.0, 0.0};

        path_walk_add(scene, &walk, &stream, radiance);
        tally_add(&tally, radiance[0]);
    }
    return tally;
}

// They say in how many ways light is looked for, not how much there is.
static void second_paths_change_no_light(void **state)
{
    static const int ORDERS[] = {3, SCENE_ORDERS_ALL};

    for (int lamp = 0; lamp < 3; lamp++)
        for (size_t k = 0; k < 4; k++) {
            struct tally with, without;
            struct path_scene scene;
            struct still still;

            fill_narrow_media(&still, lamp, k < 2 ? 1.0 : -1.0);
            path_scene_init(&scene, &still, ORDERS[k % 2]);
            assert_true(scene.media[0].aim_vertices > 0 && scene.media[1].aim_vertices > 0);
            with = look_through(&scene, 20000, 1);
            for (size_t i = 0; i < 2; i++)
                scene.media[i].aim_vertices = 0;
            without = look_through(&scene, 80000, 2);
            path_scene_finish(&scene);
            print_message("lamps %d, %s: with %.5f +- %.5f, without %.5f +- %.5f\n", lamp, k < 2 ? "ahead" : "back",
                          with.mean, tally_find_error(&with), without.mean, tally_find_error(&without));
            assert_by_chance(with.mean, hypot(tally_find_error(&with), tally_find_error(&without)), without.mean, 0.12,
                             0.0);
        }
}

static int count_vertices(double g)
{
    struct path_scene scene;
    struct still still;
    int count;

    solid_still_init(&still);
    path_still_set_g(path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.0, 0.0), g);
    path_scene_init(&scene, &still, 2);
    count = scene.media[0].aim_vertices;
    path_scene_finish(&scene);
    return count;
}

// Light of lobes that are wide is found by chance.
static void only_narrow_lobes_send_them(void **state)
{
    assert_int_equal(count_vertices(0.0), 0);
    assert_int_equal(count_vertices(0.8), 0);
    assert_int_equal(count_vertices(-0.8), 0);
    assert_int_equal(count_vertices(-0.95), 14);
    assert_int_equal(count_vertices(0.85), 4);
    assert_int_equal(count_vertices(0.95), 14);
    assert_int_equal(count_vertices(0.999), PATH_AIM_VERTICES);
}

// The chance that a vertex sends one, whose path came flying towards the sun (`side` 1) or away from it (-1).
static double find_chance(double g, double side)
{
    const struct vec3 light = {0.0, 0.0, -1.0};
    struct path_scene scene;
    struct still still;
    struct path_vertex vertex = {.incoming = vec3_scale(light, -side)};
    struct path_aim aim = {0};

    solid_still_init(&still);
    path_still_set_g(path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.0, 0.0), g);
    path_still_add_sun(&still, light, 1.0);
    path_scene_init(&scene, &still, 3);
    vertex.medium = scene.media[0].medium;
    vertex.turn = scene.media[0].turn;
    vertex.aim_vertices = scene.media[0].aim_vertices;
    path_aim_look(&aim, &scene, &vertex);
    path_scene_finish(&scene);
    assert_int_equal(aim.lamp_count, 1);
    return aim.chances[0];
}

// Towards the sun, or where media turn light back, away from it.
static void vertices_send_them_where_they_turn_easily(void **state)
{
    assert_float_equal(find_chance(0.9, 1.0), 1.0, 0.0);
    assert_float_equal(find_chance(0.9, -1.0), 0.1, 1e-12);
    assert_float_equal(find_chance(-0.9, 1.0), 1.0, 0.0);
    assert_float_equal(find_chance(-0.9, -1.0), 0.1, 1e-12);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(second_paths_change_no_light),
        cmocka_unit_test(only_narrow_lobes_send_them),
        cmocka_unit_test(vertices_send_them_where_they_turn_easily),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
