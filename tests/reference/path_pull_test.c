// Several paths go on from vertices near lamps inside of thick media: the mean stays, and noise costs less.
// SPDX-License-Identifier: Apache-2.0
#include "reference/path_pull.h"

#include "reference/path_walk.h"
#include "tests/support/path_still.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double PI = 3.14159265358979323846;

static void pull_falls_as_diffused_light(void **state)
{
    const struct box even = {.half = {INFINITY, INFINITY, INFINITY}}, slab = {.half = {INFINITY, INFINITY, 0.5}};
    struct path_pull pull = {0};
    struct vec3 lamp = {1.0, 2.0, 3.0}, beside = {1.0, 4.0, 3.0}, away = {2e5, 0.0, 0.0};

    (void)state;
    assert_true(path_pull_at(&pull, lamp) == 0.0);
    assert_true(path_pull_growth(&pull, lamp, 0.0) == 1.0);
    assert_float_equal(path_pull_fall(3.0, 0.25, &even), 1.5, 1e-12);
    // A slab leaks through both faces.
    assert_float_equal(path_pull_fall(3.0, 0.0, &slab), PI / (1.0 + 2.0 * 0.71 / 3.0), 1e-12);
    path_pull_add(&pull, &(struct path_pull_lamp){lamp, 5.0, 1.5});
    assert_float_equal(path_pull_at(&pull, lamp), 5.0, 1e-12);
    assert_float_equal(path_pull_at(&pull, beside), 5.0 * exp(-3.0), 1e-12);
    assert_float_equal(path_pull_growth(&pull, lamp, path_pull_at(&pull, beside)), exp(3.0), 1e-9);
    assert_float_equal(path_pull_growth(&pull, beside, path_pull_at(&pull, lamp)), 1.0, 1e-12);
    // Far away nothing is left of it, and no path is split without end.
    assert_float_equal(path_pull_growth(&pull, lamp, 1e-6), PATH_PULL_MOST, 1e-12);
    assert_true(path_pull_at(&pull, away) == 0.0);
    assert_float_equal(path_pull_growth(&pull, lamp, 0.0), 1.0, 1e-12);
    path_pull_add(&pull, &(struct path_pull_lamp){beside, 2.0, 1.5});
    assert_true(path_pull_at(&pull, beside) > 2.0);
}

// The mean of paths that see a ball's face, its standard error, and random numbers of each.
struct look {
    double mean, error, draws;
};

static struct look look_at(const struct path_scene *scene, double off, int count, uint64_t seed)
{
    struct look look = {0};
    double squares = 0.0;

    for (int i = 0; i < count; i++) {
        struct path_walk walk = {.ray = {{off, 0.0, 3.0}, {0.0, 0.0, -1.0}}, .far = INFINITY, .is_seen = true};
        struct stream stream = stream_of(seed, (uint64_t)i);
        double radiance[3] = {0.0, 0.0, 0.0}, from;

        path_walk_force(scene, &walk);
        path_walk_add(scene, &walk, &stream, radiance);
        from = radiance[0] - look.mean;
        look.mean += from / (i + 1);
        squares += from * (radiance[0] - look.mean);
        look.draws += (double)stream.drawn / count;
    }
    look.error = sqrt(squares / ((double)count * (count - 1)));
    return look;
}

// Returns how many times as long it takes without splitting until the noise is the same.
static double compare(struct still *still, int orders, int count)
{
    struct look split, plain;
    struct path_scene scene;
    double gain;

    path_scene_init(&scene, still, orders);
    assert_true(scene.pull.count > 0 && scene.pull.lamps[0].fall > 0.0);
    split = look_at(&scene, 0.2, count, 1);
    scene.pull = (struct path_pull){0};
    plain = look_at(&scene, 0.2, 4 * count, 2);
    path_scene_finish(&scene);
    gain = plain.error * plain.error * 4 * plain.draws / (split.error * split.error * split.draws);
    print_message("%.5g (%.1g) and %.5g (%.1g): %.2f times\n", split.mean, split.error, plain.mean, plain.error, gain);
    assert_by_chance(split.mean, hypot(split.error, plain.error), plain.mean, 0.05, 0.0);
    return gain;
}

static void splitting_changes_no_light(void **state)
{
    struct still still;

    (void)state;
    // A lamp at the back of a thick ball.
    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 6.0, 0.1);
    path_still_add_point(&still, (struct vec3){0.0, 0.0, -0.6}, 1.0);
    assert_true(compare(&still, SCENE_ORDERS_ALL, 60000) > 2.0);
    (void)compare(&still, 40, 60000);
    // A sun, too, a medium that scatters forward, a glow, and another lamp.
    path_still_add_sun(&still, (struct vec3){0.0, 0.0, -1.0}, 0.05);
    path_still_add_point(&still, (struct vec3){0.5, 0.3, 0.0}, 0.02);
    path_still_set_g(&still.media[0], 0.6);
    still.media[0].emission[0] = 0.01;
    (void)compare(&still, SCENE_ORDERS_ALL, 60000);
}

// Lamps outside of media pull nobody.
static void lamps_outside_split_nothing(void **state)
{
    struct path_scene scene;
    struct still still;

    (void)state;
    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 12.0, 0.1);
    path_still_add_point(&still, (struct vec3){0.0, 0.0, -7.0}, 1.0);
    path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
    assert_int_equal(scene.pull.count, 0);
    path_scene_finish(&scene);
}

// A lamp in a large haze, and a small puff beside it through which light falls far more quickly.
static void a_puff_does_not_tell_how_light_falls_in_haze(void **state)
{
    struct path_walk walk = {.ray = {{0.3, 0.0, 6.0}, {0.0, 0.0, -1.0}}, .far = INFINITY, .is_seen = true};
    struct path_scene scene;
    struct still still;
    double drawn = 0.0;

    (void)state;
    solid_still_init(&still);
    path_still_add_box(&still, (struct vec3){2.0, 2.0, 2.0}, 1.0, 0.02);
    path_still_add_ball(&still, (struct vec3){1.5, 1.5, 0.0}, 0.2, 10.0, 20.0);
    path_still_add_point(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0);
    path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
    assert_int_equal(scene.pull.count, 1);
    assert_true(scene.pull.lamps[0].fall < 2.0);
    for (int i = 0; i < 2000; i++) {
        struct stream stream = stream_of(3, (uint64_t)i);
        double radiance[3] = {0.0, 0.0, 0.0};

        path_walk_add(&scene, &walk, &stream, radiance);
        drawn += (double)stream.drawn / 2000;
    }
    print_message("%.0f random numbers a path\n", drawn);
    assert_true(drawn < 2000.0);
    // However many ways a path is split into, it is given up where it has drawn too many numbers.
    scene.pull.lamps[0].fall = 30.0;
    walk.draws_most = 5000;
    for (int i = 0; i < 2000; i++) {
        struct stream stream = stream_of(3, (uint64_t)i);
        double radiance[3] = {0.0, 0.0, 0.0};

        path_walk_add(&scene, &walk, &stream, radiance);
        assert_true(stream.drawn < 6000);
    }
    path_scene_finish(&scene);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pull_falls_as_diffused_light),
        cmocka_unit_test(splitting_changes_no_light),
        cmocka_unit_test(lamps_outside_split_nothing),
        cmocka_unit_test(a_puff_does_not_tell_how_light_falls_in_haze),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
