// SPDX-License-Identifier: Apache-2.0
#include "reference/shape.h"

#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { SHAPES = 4 };

static void make_shapes(struct shape shapes[static SHAPES])
{
    shapes[0] = solid_sphere(0.3, -0.2, 0.1, 0.7);
    shapes[1] = solid_box((struct vec3){-0.1, 0.2, 0.3}, (struct vec3){0.5, 0.3, 0.8});
    shapes[2] = solid_plane((struct vec3){0.0, -0.1, 0.0}, (struct vec3){0.2, 1.0, -0.4});
    shapes[3] = solid_sphere(1e6, 0.0, 0.0, 0.7);
}

static struct vec3 random_vector(struct random *random)
{
    double x = random_between(random, -1.0, 1.0), y = random_between(random, -1.0, 1.0);

    return (struct vec3){x, y, random_between(random, -1.0, 1.0)};
}

// Containment by the definition of each shape, without rays.
static bool contains(const struct shape *shape, struct vec3 p)
{
    struct vec3 offset = vec3_subtract(p, shape->center);

    switch (shape->kind) {
    case SCENE_SHAPE_SPHERE:
        return vec3_length(offset) < shape->radius;
    case SCENE_SHAPE_BOX:
        return fabs(offset.x) < shape->half.x && fabs(offset.y) < shape->half.y && fabs(offset.z) < shape->half.z;
    case SCENE_SHAPE_PLANE:
        break;
    }
    return vec3_dot(offset, shape->normal) < 0.0;
}

static void stretches_are_where_the_solid_is(void **state)
{
    struct random random = {17};
    struct shape shapes[SHAPES];
    int crossed = 0;

    make_shapes(shapes);
    for (int i = 0; i < 4000; i++) {
        const struct shape *shape = &shapes[i % SHAPES];
        struct vec3 shift = {shape->center.x, 0.0, 0.0}, at = vec3_scale(random_vector(&random), 2.0);
        struct ray ray = {vec3_add(shift, at), vec3_normalize(random_vector(&random))};
        double begin, end, distance = random_between(&random, 0.0, 4.0);
        bool is_met = shape_cross(shape, &ray, &begin, &end);

        assert_int_equal(is_met && begin < distance && distance < end, contains(shape, ray_at(&ray, distance)));
        if (!is_met) continue;
        assert_true(begin >= 0.0 && begin < end);
        crossed++;
    }
    assert_true(crossed > 500);
}

static void boundary_faces_away_from_the_solid(void **state)
{
    struct random random = {18};
    struct shape shapes[SHAPES];

    make_shapes(shapes);
    for (int i = 0; i < 4000; i++) {
        const struct shape *shape = &shapes[i % SHAPES];
        struct vec3 shift = {shape->center.x, 0.0, 0.0};
        struct ray ray = {vec3_add(shift, random_vector(&random)), vec3_normalize(random_vector(&random))};
        struct vec3 point, normal;
        double begin, end;

        if (!shape_cross(shape, &ray, &begin, &end) || begin == 0.0) continue;
        point = shape_snap(shape, ray_at(&ray, begin));
        normal = shape_normal(shape, point);
        assert_near(vec3_length(normal), 1.0, 1e-14);
        assert_near(vec3_length(vec3_subtract(point, ray_at(&ray, begin))), 0.0, 1e-9);
        assert_true(vec3_dot(normal, ray.direction) < 0.0);
        assert_true(contains(shape, vec3_add(point, vec3_scale(normal, -1e-6))));
        assert_false(contains(shape, vec3_add(point, vec3_scale(normal, 1e-6))));
    }
}

// The origin may be on either side of the boundary, by rounding.
static void rays_from_the_boundary_are_inside_when_they_go_inwards(void **state)
{
    struct random random = {19};
    struct shape shapes[SHAPES];

    make_shapes(shapes);
    for (int i = 0; i < 4000; i++) {
        const struct shape *shape = &shapes[i % SHAPES];
        struct vec3 shift = {shape->center.x, 0.0, 0.0}, normal;
        struct ray ray = {vec3_add(shift, random_vector(&random)), vec3_normalize(random_vector(&random))};
        double begin, end;

        if (!shape_cross(shape, &ray, &begin, &end) || begin == 0.0) continue;
        ray.origin = shape_snap(shape, ray_at(&ray, begin));
        normal = shape_normal(shape, ray.origin);
        assert_true(shape_cross(shape, &ray, &begin, &end) && begin == 0.0 && end > 0.0);
        ray.direction = vec3_scale(ray.direction, -1.0);
        assert_false(shape_cross(shape, &ray, &begin, &end));
        ray.direction = vec3_normalize(vec3_cross(normal, random_vector(&random)));
        // The rays run along a plane's and a box's face; a sphere has roundings to either side.
        if (shape->kind == SCENE_SHAPE_BOX) assert_false(shape_cross(shape, &ray, &begin, &end));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stretches_are_where_the_solid_is),
        cmocka_unit_test(boundary_faces_away_from_the_solid),
        cmocka_unit_test(rays_from_the_boundary_are_inside_when_they_go_inwards),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
