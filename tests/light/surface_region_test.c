// Regions of objects: overlapping objects, cameras that start inside of them, how far media extend along a bent ray.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/optics.h"
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define SPHERE(z, radius, material)                                                                                    \
    "{\"kind\": \"sphere\", \"center\": [0, 0, " #z "], \"radius\": " #radius ", \"material\": {" material "}}"
#define BOX(z, side, material)                                                                                         \
    "{\"kind\": \"box\", \"center\": [0, 0, " #z "], \"size\": [" #side ", " #side ", " #side                          \
    "], \"material\": {" material "}}"
#define RED "\"kind\": \"diffuse\", \"albedo\": [1, 0, 0]"
#define GREEN "\"kind\": \"diffuse\", \"albedo\": [0, 1, 0]"
#define AIR "\"kind\": \"dielectric\", \"ior\": 1"
#define INK(sigma) "\"kind\": \"dielectric\", \"ior\": 1, \"interior\": {\"sigma_a\": [" sigma "]}"
// White seen at normal incidence is 1.
#define HEADLIGHT "{\"kind\": \"sun\", \"direction\": [0, 0, -1], \"intensity\": 3.141592653589793}"
#define FOG "{\"density\": {\"kind\": \"homogeneous\"}, \"sigma_a\": 0.3}"

enum { SIDE_PX = 5, MIDDLE = 12 };

// The camera looks along -z; the middle pixel does so exactly.
static struct studio_picture shoot(const char *objects, const char *media, double z, const char *background)
{
    const struct studio_scene scene = {.width_px = SIDE_PX,
                                       .height_px = SIDE_PX,
                                       .camera = {.position = {0, 0, z}, .target = {0, 0, z - 10}, .fov = 2},
                                       .lights = HEADLIGHT,
                                       .media = media,
                                       .objects = objects,
                                       .background = background};
    struct studio_picture picture;

    studio_shoot(&scene, &picture);
    return picture;
}

struct middle {
    double rgb[3], alpha, transmittance[3], depth;
};

static struct middle measure_middle(const char *objects, const char *media, double z)
{
    struct studio_picture picture = shoot(objects, media, z, NULL);
    struct middle middle = {.alpha = picture.image.rgba[4 * MIDDLE + 3], .depth = picture.image.depth[MIDDLE]};

    for (int c = 0; c < 3; ++c) {
        middle.rgb[c] = picture.image.rgba[4 * MIDDLE + c];
        middle.transmittance[c] = picture.image.transmittance[4 * MIDDLE + c];
    }
    studio_finish(&picture);
    return middle;
}

static void assert_middle(const char *objects, const char *media, double z, const double rgb[3], double depth)
{
    struct middle middle = measure_middle(objects, media, z);

    for (int c = 0; c < 3; ++c) {
        assert_near(middle.rgb[c], rgb[c], 1e-5);
        assert_near(middle.transmittance[c], 0.0, 0.0);
    }
    assert_near(middle.alpha, 1.0, 0.0);
    assert_near(middle.depth, depth, 1e-5);
}

static void the_later_of_two_is_there_alone(void **state)
{
    static const double red[3] = {1, 0, 0}, green[3] = {0, 1, 0};

    (void)state;
    assert_middle(SPHERE(0, 1, RED) ", " SPHERE(0.5, 1, GREEN), NULL, 4, green, 2.5);
    assert_middle(SPHERE(0.5, 1, GREEN) ", " SPHERE(0, 1, RED), NULL, 4, green, 2.5);
    // The later of two coincident objects has the surface.
    assert_middle(SPHERE(0, 1, RED) ", " SPHERE(0, 1, GREEN), NULL, 4, green, 3);
    assert_middle(SPHERE(0, 1, GREEN) ", " SPHERE(0, 1, RED), NULL, 4, red, 3);
    assert_middle(BOX(0, 2, RED) ", " SPHERE(0, 0.9, GREEN), NULL, 4, red, 3);
    assert_middle(BOX(0, 2, RED) ", " BOX(-0.5, 3, GREEN), NULL, 4, green, 3);
    assert_middle(BOX(-0.5, 3, GREEN) ", " BOX(0, 2, RED), NULL, 4, red, 3);
    assert_middle(SPHERE(0, 1, GREEN) ", " SPHERE(0, 0.5, RED), NULL, 4, green, 3);
}

// A later ball of air cuts a bite out of the box; objects behind the ball are seen at its far side.
static void a_bite_shows_what_is_behind(void **state)
{
    static const double red[3] = {1, 0, 0}, green[3] = {0, 1, 0};

    (void)state;
    // The ball's boundary is a surface too, and the first one.
    assert_middle(BOX(0, 2, RED) ", " SPHERE(1, 0.5, AIR), NULL, 4, red, 2.5);
    assert_middle(BOX(0, 2, RED) ", " SPHERE(1, 0.5, AIR) ", " SPHERE(0.5, 0.2, GREEN), NULL, 4, green, 2.5);
    // An earlier ball cuts nothing out, but the part of it outside of the box is met first.
    assert_middle(SPHERE(1, 0.5, AIR) ", " BOX(0, 2, RED), NULL, 4, red, 2.5);
}

static void a_hole_goes_all_the_way_through(void **state)
{
    struct middle middle = measure_middle(BOX(0, 2, RED) ", " SPHERE(0, 3, AIR), NULL, 6);

    (void)state;
    assert_near(middle.alpha, 0.0, 0.0);
    assert_near(middle.rgb[0], 0.0, 0.0);
}

// The ray passes 0.5 m of the first medium, 2 m of the other, which ends last, and none after that.
static void overlapping_inks_do_not_add(void **state)
{
    struct middle middle = measure_middle(SPHERE(0.5, 1, INK("1, 0, 2")) ", " SPHERE(0, 1, INK("0, 1, 0.5")), NULL, 4),
                  same;

    (void)state;
    assert_near(middle.transmittance[0], exp(-0.5), 1e-6);
    assert_near(middle.transmittance[1], exp(-2.0), 1e-6);
    assert_near(middle.transmittance[2], exp(-2.0 * 0.5 - 2.0 * 0.5), 1e-6);
    same = measure_middle(SPHERE(0, 1, INK("0, 1, 0.5")) ", " SPHERE(0.5, 1, INK("1, 0, 2")), NULL, 4);
    assert_near(same.transmittance[0], exp(-2.0), 1e-6);
    assert_near(same.transmittance[1], exp(-0.5), 1e-6);
}

// Fog fills only the air outside of objects.
static void fog_stays_out_of_glass(void **state)
{
    static const char bounded[] =
        "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"radius\": "
        "2}}, \"sigma_a\": 0.3}";

    (void)state;
    assert_near(measure_middle(SPHERE(0, 1, AIR), bounded, 4).transmittance[0], exp(-0.3 * 2), 1e-6);
    assert_near(measure_middle(SPHERE(0, 1, INK("1, 1, 1")), bounded, 4).transmittance[0], exp(-0.3 * 2 - 2), 1e-6);
    assert_near(measure_middle(SPHERE(0, 3, AIR), bounded, 4).transmittance[0], 1.0, 0.0);
}

static void a_union_is_one_piece(void **state)
{
    static const char two[] = "{\"kind\": \"union\", \"material\": {" INK(
        "1, 2, 3") "}, \"of\": [{\"kind\": \"sphere\", "
                   "\"center\": [0, 0, 0.4], \"radius\": 1}, {\"kind\": \"box\", \"center\": [0, 0, -0.4], "
                   "\"size\": [2, 2, 2]}, {\"kind\": \"sphere\", \"center\": [0, 0, -3], \"radius\": 0.5}]}";
    struct middle middle = measure_middle(two, NULL, 4);

    (void)state;
    for (int c = 0; c < 3; ++c)
        assert_near(middle.transmittance[c], exp(-(c + 1) * (2.8 + 1)), 1e-6);
    assert_near(middle.depth, 2.6, 1e-5);
}

static void a_camera_in_opaque_stuff_sees_black(void **state)
{
    static const double black[3] = {0, 0, 0};
    struct middle middle = measure_middle(SPHERE(0, 1, RED), NULL, 0.5);

    (void)state;
    for (int c = 0; c < 3; ++c) {
        assert_near(middle.rgb[c], black[c], 0.0);
        assert_near(middle.transmittance[c], 0.0, 0.0);
    }
    assert_near(middle.alpha, 1.0, 0.0);
    middle =
        measure_middle("{\"kind\": \"plane\", \"point\": [0, 1, 0], \"material\": {\"kind\": \"mirror\"}}", FOG, 0);
    assert_near(middle.rgb[0], 0.0, 0.0);
    assert_near(middle.alpha, 1.0, 0.0);
    // A later ball of air makes room around the camera, where no light enters.
    middle = measure_middle(SPHERE(0, 1, RED) ", " SPHERE(0, 0.5, AIR), NULL, 0);
    assert_near(middle.rgb[0], 0.0, 0.0);
    assert_near(middle.depth, 0.5, 1e-5);
}

static void a_camera_in_ink_has_the_rest_of_it_before_it(void **state)
{
    struct middle middle = measure_middle(SPHERE(0, 1, INK("1, 2, 0.5")), NULL, 0.25);

    (void)state;
    assert_near(middle.transmittance[0], exp(-1.25), 1e-6);
    assert_near(middle.transmittance[1], exp(-2.5), 1e-6);
    assert_near(middle.transmittance[2], exp(-0.625), 1e-6);
}

// The ray meets no boundary where it starts.
static void a_camera_in_one_shape_of_a_union_is_in_it(void **state)
{
    static const char two[] =
        "{\"kind\": \"union\", \"material\": {\"kind\": \"dielectric\", \"ior\": 1.5, \"interior\": {\"sigma_a\": 1}}, "
        "\"of\": [{\"kind\": \"sphere\", \"center\": [0, 0, 9], \"radius\": 1}, "
        "{\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1}]}";
    struct middle middle = measure_middle(two, NULL, 0.25);

    (void)state;
    assert_near(middle.transmittance[0], 0.96 * exp(-1.25), 1e-6);
}

// A camera on the surface may be on either side of it.
static void a_camera_on_a_surface_sees_one_side(void **state)
{
    const double inside = exp(-2.0);
    struct middle middle = measure_middle(SPHERE(0, 1, INK("1, 1, 1")), NULL, 1);

    (void)state;
    assert_near(middle.transmittance[0], inside, 1e-6);
    middle = measure_middle(BOX(0, 2, INK("1, 1, 1")), NULL, 1);
    assert_near(middle.transmittance[0], inside, 1e-6);
    middle = measure_middle(SPHERE(0, 1, INK("1, 1, 1")), NULL, -1);
    assert_near(middle.transmittance[0], 1.0, 1e-6);
    middle = measure_middle(BOX(0, 2, INK("1, 1, 1")), NULL, -1);
    assert_near(middle.transmittance[0], 1.0, 1e-6);
}

// Depth is that of the first surface, unless half of the light is lost before it.
static void depth_is_what_comes_first(void **state)
{
    static const char dense[] =
        "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"center\": "
        "[0, 0, 2], \"radius\": 0.5}}, \"sigma_a\": 2}";
    static const char thin[] =
        "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"center\": [0, "
        "0, 2], \"radius\": 0.5}}, \"sigma_a\": 0.2}";

    (void)state;
    assert_near(measure_middle(SPHERE(0, 1, RED), dense, 4).depth, 1.5 + log(2.0) / 2.0, 1e-3);
    assert_near(measure_middle(SPHERE(0, 1, RED), thin, 4).depth, 3.0, 1e-5);
    assert_near(measure_middle(SPHERE(0, 1, AIR) ", " SPHERE(0, 0.5, RED), NULL, 4).depth, 3.0, 1e-5);
    assert_near(measure_middle(SPHERE(9, 1, RED), NULL, 4).depth, 0.0, 0.0);
}

static void a_background_makes_a_picture_opaque(void **state)
{
    struct studio_picture picture = shoot(SPHERE(0, 1, INK("1, 2, 3")), NULL, 4, "[0.5, 0.25, 2]");

    (void)state;
    assert_near(picture.image.rgba[4 * MIDDLE], 0.5 * exp(-2.0), 1e-6);
    assert_near(picture.image.rgba[4 * MIDDLE + 1], 0.25 * exp(-4.0), 1e-6);
    assert_near(picture.image.rgba[4 * MIDDLE + 2], 2.0 * exp(-6.0), 1e-6);
    assert_near(picture.image.rgba[4 * MIDDLE + 3], 1.0, 0.0);
    assert_near(picture.image.transmittance[4 * MIDDLE + 1], exp(-4.0), 1e-6);
    studio_finish(&picture);
}

// A mirror reflects light that does not come from straight behind it.
static void a_mirror_is_opaque(void **state)
{
    struct studio_picture picture =
        shoot(SPHERE(0, 1, "\"kind\": \"mirror\", \"reflectance\": [0.9, 0.5, 0.1]"), NULL, 4, "2");

    (void)state;
    assert_near(picture.image.rgba[4 * MIDDLE], 1.8, 1e-6);
    assert_near(picture.image.rgba[4 * MIDDLE + 1], 1.0, 1e-6);
    assert_near(picture.image.rgba[4 * MIDDLE + 2], 0.2, 1e-6);
    assert_near(picture.image.rgba[4 * MIDDLE + 3], 1.0, 0.0);
    assert_near(picture.image.transmittance[4 * MIDDLE], 0.0, 0.0);
    assert_near(picture.image.depth[MIDDLE], 3.0, 1e-5);
    studio_finish(&picture);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_later_of_two_is_there_alone),
        cmocka_unit_test(a_bite_shows_what_is_behind),
        cmocka_unit_test(a_hole_goes_all_the_way_through),
        cmocka_unit_test(overlapping_inks_do_not_add),
        cmocka_unit_test(fog_stays_out_of_glass),
        cmocka_unit_test(a_union_is_one_piece),
        cmocka_unit_test(a_camera_in_opaque_stuff_sees_black),
        cmocka_unit_test(a_camera_in_ink_has_the_rest_of_it_before_it),
        cmocka_unit_test(a_camera_in_one_shape_of_a_union_is_in_it),
        cmocka_unit_test(a_camera_on_a_surface_sees_one_side),
        cmocka_unit_test(depth_is_what_comes_first),
        cmocka_unit_test(a_background_makes_a_picture_opaque),
        cmocka_unit_test(a_mirror_is_opaque),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
