// SPDX-License-Identifier: Apache-2.0
#include "reference/camera_pinhole.h"
#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// The camera looks along +z from z = -2; the image plane z = 0 then spans [-2, 2] x [-1, 1]. Right is -x, since forward
// is +z and up +y.
static struct camera_pinhole camera_with(bool mirror)
{
    struct camera_pinhole camera;

    camera_pinhole_init(&camera, &(struct camera_pinhole_params){.position = {0.0, 0.0, -2.0},
                                                                 .up = {0.0, 1.0, 0.0},
                                                                 .fov_deg = 2.0 * atan(0.5) * 180.0 / M_PI,
                                                                 .width_px = 200,
                                                                 .height_px = 100,
                                                                 .mirror = mirror});
    return camera;
}

static void assert_meets(const struct camera_pinhole *camera, double x, double y, double plane_x, double plane_y)
{
    struct ray ray = camera_pinhole_ray(camera, x, y);
    struct vec3 hit = ray_at(&ray, 2.0 / ray.direction.z);

    assert_near(vec3_length(ray.direction), 1.0, 1e-15);
    assert_near(hit.x, plane_x, 1e-14); // a few roundings
    assert_near(hit.y, plane_y, 1e-14);
}

static void image_edges_lie_at_the_field_of_view(void **state)
{
    struct camera_pinhole camera = camera_with(false);

    assert_meets(&camera, 100.0, 50.0, 0.0, 0.0);
    assert_meets(&camera, 100.0, 0.0, 0.0, 1.0);
    assert_meets(&camera, 100.0, 100.0, 0.0, -1.0);
    assert_meets(&camera, 200.0, 50.0, -2.0, 0.0);
    assert_meets(&camera, 0.0, 50.0, 2.0, 0.0);
}

static void mirror_flips_x_alone(void **state)
{
    struct camera_pinhole camera = camera_with(true);

    assert_meets(&camera, 150.0, 25.0, 1.0, 0.5);
    assert_meets(&camera, 0.0, 0.0, -2.0, 1.0);
}

static void tilted_up_turns_the_image(void **state)
{
    struct camera_pinhole camera;
    struct ray ray;

    camera_pinhole_init(&camera, &(struct camera_pinhole_params){.position = {1.0, 2.0, 3.0},
                                                                 .target = {1.0, 2.0, 0.0},
                                                                 .up = {5.0, 0.0, 1.0},
                                                                 .fov_deg = 90.0,
                                                                 .width_px = 10,
                                                                 .height_px = 10});
    ray = camera_pinhole_ray(&camera, 5.0, 0.0);
    assert_near(ray.direction.x, sqrt(0.5), 1e-15);
    assert_near(ray.direction.y, 0.0, 1e-15);
    assert_near(ray.direction.z, -sqrt(0.5), 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(image_edges_lie_at_the_field_of_view),
        cmocka_unit_test(mirror_flips_x_alone),
        cmocka_unit_test(tilted_up_turns_the_image),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
