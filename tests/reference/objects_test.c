// SPDX-License-Identifier: Apache-2.0
#include "reference/objects.h"

#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct ray DOWN_Z = {{0.0, 0.0, 4.0}, {0.0, 0.0, -1.0}};

struct wanted_piece {
    double end;
    size_t region;
};

static void assert_walk(const struct still *still, const struct ray *ray, const struct wanted_piece *wanted,
                        size_t count)
{
    struct object_walk walk;
    double begin = 0.0;

    objects_walk(&still->objects, ray, INFINITY, &walk);
    assert_int_equal(walk.count, count);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(walk.pieces[i].region, wanted[i].region);
        assert_near(walk.pieces[i].begin, begin, 0.0);
        if (isfinite(wanted[i].end)) assert_near(walk.pieces[i].end, wanted[i].end, 1e-12);
        begin = walk.pieces[i].end;
    }
    assert_true(isinf(begin));
}

static void later_objects_replace_earlier_ones(void **state)
{
    const struct shape big = solid_sphere(0.0, 0.0, 0.0, 2.0), small = solid_sphere(0.0, 0.0, 0.0, 1.0);
    const struct shape aside = solid_sphere(0.0, 0.0, 2.0, 0.5);
    const struct material glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5);
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &glass, &big, 1);
    solid_still_add(&still, &glass, &small, 1);
    solid_still_add(&still, &glass, &aside, 1);
    assert_walk(&still, &DOWN_Z,
                (const struct wanted_piece[]){{1.5, 0}, {2.5, 3}, {3.0, 1}, {5.0, 2}, {6.0, 1}, {INFINITY, 0}}, 6);
    // The big sphere comes last and hides the small one.
    solid_still_init(&still);
    solid_still_add(&still, &glass, &small, 1);
    solid_still_add(&still, &glass, &big, 1);
    assert_walk(&still, &DOWN_Z, (const struct wanted_piece[]){{2.0, 0}, {6.0, 2}, {INFINITY, 0}}, 3);
}

static void unions_have_no_boundaries_inside(void **state)
{
    const struct shape shapes[] = {solid_sphere(0.0, 0.0, -1.0, 1.0),
                                   solid_box((struct vec3){0.0, 0.0, 0.5}, (struct vec3){0.5, 0.5, 1.0}),
                                   solid_box((struct vec3){0.0, 0.0, 2.0}, (struct vec3){0.5, 0.5, 0.5})};
    const struct material glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5);
    struct object_walk walk;
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &glass, shapes, 3);
    // The boxes touch; the sphere overlaps one of them.
    assert_walk(&still, &DOWN_Z, (const struct wanted_piece[]){{1.5, 0}, {6.0, 1}, {INFINITY, 0}}, 3);
    objects_walk(&still.objects, &DOWN_Z, INFINITY, &walk);
    assert_int_equal(walk.pieces[0].shape, 2);
    assert_int_equal(walk.pieces[1].shape, 0);
}

static void boundaries_in_one_place_are_crossed_together(void **state)
{
    const struct shape plate = solid_box((struct vec3){0.0, 0.0, 0.1}, (struct vec3){1.0, 1.0, 0.3});
    const struct shape wall = solid_plane((struct vec3){0.3, 0.7, -0.2}, (struct vec3){0.0, 0.0, 1.0});
    const struct material glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5), white = solid_diffuse(1.0);

    for (int order = 0; order < 2; order++) {
        struct random random = {5};

        for (int i = 0; i < 1000; i++) {
            double x = random_between(&random, -0.4, 0.4), y = random_between(&random, -0.4, 0.4);
            struct vec3 target = {random_between(&random, -0.4, 0.4), random_between(&random, -0.4, 0.4), -0.2};
            struct ray ray = {{x, y, 4.0}, {0.0, 0.0, 0.0}};
            struct object_walk walk;
            struct still still;

            ray.direction = vec3_normalize(vec3_subtract(target, ray.origin));
            solid_still_init(&still);
            solid_still_add(&still, order ? &white : &glass, order ? &wall : &plate, 1);
            solid_still_add(&still, order ? &glass : &white, order ? &plate : &wall, 1);
            objects_walk(&still.objects, &ray, INFINITY, &walk);
            assert_int_equal(walk.count, 3);
            assert_int_equal(walk.pieces[1].region, order ? 2 : 1);
            assert_int_equal(walk.pieces[2].region, order ? 1 : 2);
            // A ray from that point goes into the wall, or back into the plate.
            ray.origin = ray_at(&ray, walk.pieces[1].end);
            objects_walk(&still.objects, &ray, INFINITY, &walk);
            assert_int_equal(walk.count, 1);
            assert_int_equal(walk.pieces[0].region, order ? 1 : 2);
            ray.direction = vec3_scale(ray.direction, -1.0);
            objects_walk(&still.objects, &ray, INFINITY, &walk);
            assert_int_equal(walk.count, 2);
            assert_int_equal(walk.pieces[0].region, order ? 2 : 1);
        }
    }
}

static void walks_end_at_the_given_distance(void **state)
{
    const struct shape ball = solid_sphere(0.0, 0.0, 0.0, 1.0);
    const struct material glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5);
    struct object_walk walk;
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &glass, &ball, 1);
    objects_walk(&still.objects, &DOWN_Z, 3.5, &walk);
    assert_int_equal(walk.count, 2);
    assert_near(walk.pieces[1].end, 3.5, 0.0);
    objects_walk(&still.objects, &DOWN_Z, 2.0, &walk);
    assert_int_equal(walk.count, 1);
    objects_walk(&still.objects, &DOWN_Z, 0.0, &walk);
    assert_int_equal(walk.count, 1);
    assert_int_equal(walk.pieces[0].region, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(later_objects_replace_earlier_ones),
        cmocka_unit_test(unions_have_no_boundaries_inside),
        cmocka_unit_test(boundaries_in_one_place_are_crossed_together),
        cmocka_unit_test(walks_end_at_the_given_distance),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
