// Boundaries of several objects that coincide: in corners, and faces that lie in one plane.
// SPDX-License-Identifier: Apache-2.0
// No light is lost between them, and none gets through.
#include "tests/support/assert_near.h"
#include "tests/support/studio.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define PLANE(normal, material)                                                                                        \
    "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"normal\": " normal ", \"material\": {" material "}}"
#define DIM_MIRROR "\"kind\": \"mirror\", \"reflectance\": 0.5"
#define WHITE "\"kind\": \"diffuse\", \"albedo\": 1"
#define BLACK "\"kind\": \"diffuse\", \"albedo\": 0"

// Both walls are met at once in the middle column of pixels.
static void a_corner_reflects_twice(void **state)
{
    const struct studio_scene scene = {.width_px = 9,
                                       .height_px = 5,
                                       .camera = {.position = {0, 0, 4}, .fov = 30},
                                       .background = "1",
                                       .objects = PLANE("[1, 0, 1]", DIM_MIRROR) ", " PLANE("[-1, 0, 1]", DIM_MIRROR)};
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    for (int i = 0; i < 45; ++i)
        for (int c = 0; c < 3; ++c)
            assert_near(picture.image.rgba[4 * i + c], 0.25, 1e-5);
    assert_near(picture.result.ray_counts.rays, 3.0, 0.0);
    studio_finish(&picture);
}

// The lamp is below the floor, in front of the wall.
static void no_light_comes_through_a_corner(void **state)
{
    const struct studio_scene scene = {
        .width_px = 5,
        .height_px = 9,
        .camera = {.position = {0, 4, 4}, .fov = 30},
        .lights = "{\"kind\": \"point\", \"position\": [0, -1, 1], \"intensity\": 10}",
        .objects = PLANE("[0, 1, 0]", WHITE) ", " PLANE("[0, 0, 1]", WHITE),
    };
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    for (int i = 0; i < 45; ++i)
        for (int c = 0; c < 3; ++c)
            assert_near(picture.image.rgba[4 * i + c], 0.0, 0.0);
    studio_finish(&picture);
}

// A black box lies in glass in a wall, their faces in one plane far from a camera at the origin. Glass in front of the
// box would shine.
static void the_last_of_flush_faces_is_seen_from_afar(void **state)
{
    static const double distances[] = {10.1, 100.3, 1000.1, 12345.6};

    (void)state;
    for (size_t i = 0; i < sizeof distances / sizeof *distances; ++i) {
        double at = distances[i];
        char objects[1024];
        const struct studio_scene scene = {.width_px = 32,
                                           .height_px = 32,
                                           .camera = {.target = {0, 0, -1}, .fov = 50.0 / at},
                                           .background = "1",
                                           .objects = objects};
        struct studio_picture picture;

        snprintf(objects, sizeof objects,
                 "{\"kind\": \"plane\", \"point\": [0, 0, %.9g], \"normal\": [0, 0, 1], \"material\": {" WHITE "}}, "
                 "{\"kind\": \"box\", \"center\": [0, 0, %.9g], \"size\": [9, 9, 1.026], \"material\": {\"kind\": "
                 "\"dielectric\", \"ior\": 1.5}}, "
                 "{\"kind\": \"box\", \"center\": [0, 0, %.9g], \"size\": [5, 5, 0.7], \"material\": {" BLACK "}}",
                 -at, -at - 0.513, -at - 0.35);
        studio_shoot(&scene, &picture);
        for (int k = 0; k < 32 * 32; ++k)
            assert_near(picture.image.rgba[4 * k], 0.0, 0.0);
        studio_finish(&picture);
    }
}

// The second of three boxes touches the first one's back, the third overlaps it: a ray is refracted at the union's
// outer faces alone.
static void a_union_has_no_walls_within(void **state)
{
    static const double distances[] = {10.1, 1000.1};

    (void)state;
    for (size_t i = 0; i < sizeof distances / sizeof *distances; ++i) {
        double at = distances[i];
        char objects[1024];
        const struct studio_scene scene = {.width_px = 16,
                                           .height_px = 16,
                                           .camera = {.target = {0, 0, -1}, .fov = 50.0 / at},
                                           .background = "1",
                                           .objects = objects};
        struct studio_picture picture;

        snprintf(objects, sizeof objects,
                 "{\"kind\": \"union\", \"of\": ["
                 "{\"kind\": \"box\", \"center\": [0, 0, %.9g], \"size\": [9, 9, 1.026]}, "
                 "{\"kind\": \"box\", \"center\": [0, 0, %.9g], \"size\": [9, 9, 0.7]}, "
                 "{\"kind\": \"box\", \"center\": [0, 0, %.9g], \"size\": [9, 9, 0.3]}], "
                 "\"material\": {\"kind\": \"dielectric\", \"ior\": 1.5, \"fresnel\": \"none\"}}",
                 -at - 0.513, -at - 1.026 - 0.35, -at - 1.026 - 0.8);
        studio_shoot(&scene, &picture);
        assert_near(picture.result.ray_counts.rays, 3.0, 0.0);
        studio_finish(&picture);
    }
}

// A later block contains a ball: rays are refracted at the block's faces and not at the ball.
static void replaced_surfaces_are_not_met(void **state)
{
    const struct studio_scene scene = {
        .width_px = 8,
        .height_px = 8,
        .camera = {.position = {0, 0, 4}, .fov = 5},
        .background = "1",
        .objects =
            "{\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.5, \"material\": {\"kind\": \"dielectric\", "
            "\"ior\": 1.3}}, {\"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [9, 9, 2], \"material\": {\"kind\": "
            "\"dielectric\", \"ior\": 1.5, \"fresnel\": \"none\"}}"};
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    assert_near(picture.result.ray_counts.rays, 3.0, 0.0);
    studio_finish(&picture);
}

static const struct vec3 lamp = {0.3, -1.3, 0.1};

// The wall at z = -3 gets an irradiance of pi where it faces the lamp.
static void lit_wall(const struct ray *ray, struct studio_light *light, const void *user)
{
    double at = (-3.0 - ray->origin.z) / ray->direction.z;
    struct vec3 point = ray_at(ray, at);

    (void)user;
    if (point.y < -1.29) return;
    studio_set_color(light->radiance, 3.1 / vec3_length(vec3_subtract(lamp, point)));
}

static void check_lamp_on_a_floor(const char *objects)
{
    const struct studio_scene scene = {.width_px = 32,
                                       .height_px = 32,
                                       .camera = {.position = {0, 0.7, 2}, .target = {0, 0, -3}, .fov = 50},
                                       .lights =
                                           "{\"kind\": \"point\", \"falloff\": \"none\", \"position\": [0.3, -1.3, "
                                           "0.1], \"intensity\": 3.141592653589793}",
                                       .objects = objects};

    studio_check(&scene, lit_wall, NULL, 1e-5, 0.5);
}

#define ROOM                                                                                                           \
    "{\"kind\": \"plane\", \"point\": [0, -1.3, 0], \"material\": {" BLACK "}}, "                                      \
    "{\"kind\": \"plane\", \"point\": [0, 0, -3], \"normal\": [0, 0, 1], \"material\": {" WHITE "}}"

// Every point of the floor is as far away as the lamp.
static void a_lamp_on_a_floor_is_above_it(void **state)
{
    (void)state;
    check_lamp_on_a_floor(ROOM);
    check_lamp_on_a_floor(ROOM
                          ", {\"kind\": \"sphere\", \"center\": [0, 0, 9], \"radius\": 1, \"material\": {\"kind\": "
                          "\"dielectric\", \"ior\": 1.5}}");
}

#define FLOOR                                                                                                          \
    "{\"kind\": \"plane\", \"point\": [0, -1.241, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": 0.4, "         \
    "\"specular\": 0.62, \"fresnel\": \"none\"}}"
#define BLOCK(y, height)                                                                                               \
    "{\"kind\": \"box\", \"center\": [0.233, " #y ", 0.158], \"size\": [1.178, " #height                               \
    ", 1.137], \"material\": {\"kind\": \"dielectric\", \"ior\": 1.432}}"

static void shoot_block(const char *objects, struct studio_picture *picture)
{
    const struct studio_scene scene = {.width_px = 64,
                                       .height_px = 24,
                                       .camera = {.position = {1.838, -1.159, 2.003}, .target = {0, -1.2, 0}, .fov = 9},
                                       .lights =
                                           "{\"kind\": \"point\", \"falloff\": \"none\", \"position\": [1.3, 1.5, 2], "
                                           "\"intensity\": 3}",
                                       .background = "0.7",
                                       .objects = objects};

    studio_shoot(&scene, picture);
}

// Grazing rays meet the block's bottom and the floor far from one another, because of the last digits of a float. A
// block that is sunk into the floor has no bottom.
static void a_block_of_glass_stands_on_a_floor(void **state)
{
    struct studio_picture standing, sunk;

    (void)state;
    shoot_block(FLOOR ", " BLOCK(-0.953, 0.576), &standing);
    shoot_block(BLOCK(-0.95305, 0.5761) ", " FLOOR, &sunk);
    for (int i = 0; i < 4 * 64 * 24; ++i)
        assert_near(standing.image.rgba[i], sunk.image.rgba[i], 1e-3);
    studio_finish(&standing);
    studio_finish(&sunk);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_corner_reflects_twice),
        cmocka_unit_test(no_light_comes_through_a_corner),
        cmocka_unit_test(a_block_of_glass_stands_on_a_floor),
        cmocka_unit_test(a_lamp_on_a_floor_is_above_it),
        cmocka_unit_test(replaced_surfaces_are_not_met),
        cmocka_unit_test(a_union_has_no_walls_within),
        cmocka_unit_test(the_last_of_flush_faces_is_seen_from_afar),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
