// Images as a viewer outside sees them, and between their texels.
// SPDX-License-Identifier: Apache-2.0
#include "reference/texture.h"

#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

// An F looks different when it is mirrored or rotated, and its image has more rows than columns.
enum { F_WIDTH = 4, F_HEIGHT = 6 };

static const char *const F_ROWS[F_HEIGHT] = {"....", ".##.", ".#..", ".##.", ".#..", "...."};

static float f_image[3 * F_WIDTH * F_HEIGHT];

static struct texture make_f(void)
{
    for (int i = 0; i < F_WIDTH * F_HEIGHT; i++) {
        for (int c = 0; c < 3; c++)
            f_image[3 * i + c] = F_ROWS[i / F_WIDTH][i % F_WIDTH] == '#' ? 1.0f : 0.0f;
    }
    return (struct texture){.rgb = f_image, .width = F_WIDTH, .height = F_HEIGHT, .is_nearest = true};
}

// Suns shine evenly from all sides, so that brightness depends on the texture alone.
static void light_from_around(struct still *still)
{
    static const struct vec3 TRAVELS[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

    for (int i = 0; i < 6; i++)
        still->lights[still->light_count++] =
            (struct light){.kind = SCENE_LIGHT_SUN, .intensity = {M_PI, M_PI, M_PI}, .direction = TRAVELS[i]};
}

// Asserts that an upright viewer before a shape's face sees the F, one pixel a texel.
static void assert_face_shows_f(const struct shape *shape, struct vec3 middle, struct vec3 normal)
{
    struct material painted = solid_diffuse(1.0);
    struct still still;

    painted.texture = make_f();
    painted.texture.size[0] = 2.0;
    solid_still_init(&still);
    solid_still_add(&still, &painted, shape, 1);
    light_from_around(&still);
    // The view is 3 m high from 10 m away.
    camera_pinhole_init(&still.camera,
                        &(struct camera_pinhole_params){.position = vec3_add(middle, vec3_scale(normal, 10.0)),
                                                        .target = middle,
                                                        .up = normal.y == 0.0 ? (struct vec3){0.0, 1.0, 0.0}
                                                                              : (struct vec3){0.0, 0.0, -1.0},
                                                        .fov_deg = 2.0 * atan(0.15) * 180.0 / M_PI,
                                                        .width_px = F_WIDTH,
                                                        .height_px = F_HEIGHT,
                                                        .clip_far = INFINITY});
    for (int i = 0; i < F_WIDTH * F_HEIGHT; i++) {
        struct reference_pixel pixel = reference_measure_pixel(&still, i % F_WIDTH, i / F_WIDTH, NULL);

        assert_near(pixel.radiance[0], f_image[3 * i], 1e-12);
    }
}

static void planes_and_boxes_show_images_upright(void **state)
{
    static const struct vec3 NORMALS[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const struct vec3 center = {0.3, -0.2, 0.7}, half = {2.0, 2.5, 3.0};
    const struct shape box = solid_box(center, half);

    for (int i = 0; i < 6; i++) {
        struct vec3 n = NORMALS[i], out = {n.x * half.x, n.y * half.y, n.z * half.z};
        const struct shape plane = solid_plane(center, n);

        assert_face_shows_f(&plane, center, n);
        assert_face_shows_f(&box, vec3_add(center, out), n);
    }
}

// The image has four columns around and two rows: each side shows which four texels meet in its middle.
static void balls_are_wrapped_once(void **state)
{
    static const struct vec3 SIDES[] = {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}, {-1, 0, 0}};
    static float texels[3 * 8];
    const struct shape ball = solid_sphere(1.0, 2.0, 3.0, 1.0);
    struct texture texture = {.rgb = texels, .width = 4, .height = 2, .is_nearest = true};

    for (int i = 0; i < 8; i++)
        texels[3 * i] = texels[3 * i + 1] = texels[3 * i + 2] = (float)i / 8.0f;
    for (int i = 0; i < 4; i++) {
        struct material painted = solid_diffuse(1.0);
        struct still still;

        painted.texture = texture;
        solid_still_init(&still);
        solid_still_add(&still, &painted, &ball, 1);
        light_from_around(&still);
        camera_pinhole_init(
            &still.camera, &(struct camera_pinhole_params){.position = vec3_add(ball.center, vec3_scale(SIDES[i], 5.0)),
                                                           .target = ball.center,
                                                           .up = {0.0, 1.0, 0.0},
                                                           .fov_deg = 8.0,
                                                           .width_px = 2,
                                                           .height_px = 2,
                                                           .clip_far = INFINITY});
        for (int p = 0; p < 4; p++) {
            struct reference_pixel pixel = reference_measure_pixel(&still, p % 2, p / 2, NULL);
            int column = (1 + i + p % 2) % 4, row = p / 2;
            // Three suns light the texel, at the cosines of a normal near the axis.
            double lit = pixel.radiance[0] / ((double)(4 * row + column) / 8.0 + 1e-300);

            if (column + row > 0)
                assert_true(lit > 1.0 && lit < 1.6);
            else
                assert_near(pixel.radiance[0], 0.0, 0.0);
        }
    }
}

static void assert_color(const struct texture *texture, double u, double v, double wanted)
{
    double color[3];

    texture_sample(texture, (struct texture_coordinates){u, v}, color);
    assert_near(color[1], wanted, 1e-12);
}

static void texels_are_blended_and_repeat(void **state)
{
    static const float RGB[] = {0, 1, 0, 0, 2, 0, 0, 4, 0, 0, 8, 0, 0, 16, 0, 0, 32, 0};
    // Texels are 1 2 4 above 8 16 32.
    struct texture texture = {.rgb = RGB, .width = 3, .height = 2};

    assert_color(&texture, 0.5 / 3.0, 0.75, 1.0);
    assert_color(&texture, 2.5 / 3.0, 0.25, 32.0);
    assert_color(&texture, 1.0 / 3.0, 0.75, 1.5);
    assert_color(&texture, 1.25 / 3.0, 0.75, 1.75);
    assert_color(&texture, 0.5 / 3.0, 0.5, 4.5);
    assert_color(&texture, 0.5 / 3.0, 0.35, 0.2 * 1.0 + 0.8 * 8.0);
    // Samples lie on the borders, where the first texel follows the last.
    assert_color(&texture, 0.0, 0.75, 2.5);
    assert_color(&texture, 1.0, 0.75, 2.5);
    assert_color(&texture, 0.5 / 3.0, 0.0, 4.5);
    assert_color(&texture, 0.5 / 3.0, 1.0, 4.5);
    assert_color(&texture, 0.0, 0.0, (1.0 + 4.0 + 8.0 + 32.0) / 4.0);
    for (int shift = -3; shift <= 3; shift++)
        assert_color(&texture, 1.25 / 3.0 + shift, 0.75 - shift, 1.75);
    texture.is_nearest = true;
    assert_color(&texture, 0.99 / 3.0, 0.51, 1.0);
    assert_color(&texture, 1.01 / 3.0, 0.51, 2.0);
    assert_color(&texture, 1.01 / 3.0, 0.49, 16.0);
    assert_color(&texture, -0.01, 1.01, 32.0);
}

static void tiles_have_their_given_size(void **state)
{
    const struct shape wall = solid_plane((struct vec3){1.0, 2.0, 3.0}, (struct vec3){0.0, 0.0, 2.0});
    struct texture texture = {.rgb = f_image, .width = 4, .height = 6, .size = {2.0, 0.5}};
    struct texture_coordinates position = texture_find(&texture, &wall, (struct vec3){1.5, 2.1, 3.0});

    assert_near(position.u, 0.5 + 0.25, 1e-15);
    assert_near(position.v, 0.5 + 0.2, 1e-14);
    // The height follows from the image's proportions: 3 m.
    texture.size[1] = 0.0;
    assert_near(texture_find(&texture, &wall, (struct vec3){1.5, 2.1, 3.0}).v, 0.5 + 0.1 / 3.0, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planes_and_boxes_show_images_upright),
        cmocka_unit_test(balls_are_wrapped_once),
        cmocka_unit_test(texels_are_blended_and_repeat),
        cmocka_unit_test(tiles_have_their_given_size),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
