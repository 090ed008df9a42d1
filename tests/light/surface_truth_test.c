// Pictures of objects against the light of reference/, on both backends.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/object_job.h"
#include "tests/support/true_light.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define BACKGROUND "\"background\": [0.3, 0.4, 0.6]"
#define INTERIOR(members) ", \"interior\": {" members "}"
#define SPHERE(x, y, z, radius, material)                                                                              \
    "{\"kind\": \"sphere\", \"center\": [" #x ", " #y ", " #z "], \"radius\": " #radius ", \"material\": {" material   \
    "}}"
#define BOX(x, y, z, side, material)                                                                                   \
    "{\"kind\": \"box\", \"center\": [" #x ", " #y ", " #z "], \"size\": [" #side ", " #side ", " #side                \
    "], \"material\": {" material "}}"
#define RED "\"kind\": \"diffuse\", \"albedo\": [0.8, 0.2, 0.1]"

// Refraction and reflection are exact to the rounding of floats, which a few curved surfaces amplify; the steps of a
// march show.
static const double ROUNDING = 2e-5, MARCHING = 2e-3;

static void compare_by(const char *scene, const char *rest, const char *quality, double tolerance)
{
    static const enum gl_backend backends[] = {GL_BACKEND_SOFTWARE, GL_BACKEND_EGL};

    for (size_t i = 0; i < 2; ++i) {
        struct true_light light;
        struct job job;
        char all[1024];

        snprintf(all, sizeof all, "%s, %s", rest, quality);
        object_job_parse(&job, scene, all);
        light = true_light_compare(&job, backends[i]);
        job_finish(&job);
        assert_true(true_light_is_within(&light, tolerance));
    }
}

static void compare(const char *scene, const char *rest, double tolerance)
{
    compare_by(scene, rest, OBJECT_JOB_QUALITY, tolerance);
}

static void diffuse_objects_shade_one_another(void **state)
{
    compare("\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " SPHERE(0.5, -0.5, 0, 0.7, RED) ", " BOX(
                -1, -1.03, 0.5, 0.6, OBJECT_JOB_GREY) "]",
            OBJECT_JOB_LIGHT ", " BACKGROUND, ROUNDING);
}

static void a_diffuse_surface_has_a_specular_share(void **state)
{
    compare("\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY ", \"specular\": 0.8, \"ior\": 1.7") ", " OBJECT_JOB_BALL(
                RED ", \"specular\": 1, \"fresnel\": \"schlick\", \"f0\": 0.2") "]",
            OBJECT_JOB_LIGHT ", " BACKGROUND, ROUNDING);
}

static void mirrors_reflect_mirrors(void **state)
{
    compare("\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " SPHERE(
                0.7, -0.5, 0, 0.7,
                OBJECT_JOB_MIRROR
                ", \"reflectance\": [0.9, 0.8, 0.7]") ", " SPHERE(-0.9, -0.5, 0.2, 0.7, OBJECT_JOB_MIRROR) "]",
            OBJECT_JOB_LIGHT ", " BACKGROUND, ROUNDING);
}

static void a_glass_ball_bends_what_is_behind(void **state)
{
    compare(
        "\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " SPHERE(-1.2, -0.9, -1.5, 0.6, RED) ", " OBJECT_JOB_BALL(
            OBJECT_JOB_GLASS INTERIOR("\"sigma_s\": 0, \"sigma_a\": [0.8, 0.1, 0.3]")) "]",
        OBJECT_JOB_LIGHT ", " BACKGROUND, ROUNDING);
}

static void every_kind_of_fresnel_share(void **state)
{
    compare(
        "\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " SPHERE(
            -1, 0, 0, 0.8,
            OBJECT_JOB_GLASS
            ", \"fresnel\": \"schlick\"") ", " BOX(1, 0, 0, 0.9,
                                                   OBJECT_JOB_GLASS
                                                   ", \"fresnel\": \"none\"") ", " SPHERE(0, -0.9, 1, 0.5,
                                                                                          "\"kind\": \"dielectric\", "
                                                                                          "\"ior\": 0.8") "]",
        OBJECT_JOB_LIGHT ", " BACKGROUND, ROUNDING);
}

static void glass_within_glass(void **state)
{
    compare("\"objects\": [" OBJECT_JOB_BALL(OBJECT_JOB_GLASS INTERIOR(
                "\"sigma_s\": 0, \"sigma_a\": [0.1, 0.5, 0.5]")) ", " SPHERE(0.1, 0.1, 0, 0.8,
                                                                             "\"kind\": \"dielectric\", "
                                                                             "\"ior\": 1") ", " BOX(0.1, 0, 0.1, 0.7,
                                                                                                    "\"kind\": "
                                                                                                    "\"dielectr"
                                                                                                    "ic\", "
                                                                                                    "\"ior\": "
                                                                                                    "1."
                                                                                                    "9" INTERIOR(
                                                                                                        "\"sigm"
                                                                                                        "a_s\":"
                                                                                                        " 0, "
                                                                                                        "\"sigm"
                                                                                                        "a_a\":"
                                                                                                        " [1, "
                                                                                                        "0.2, "
                                                                                                        "0.1]")) "]",
            BACKGROUND, ROUNDING);
}

static void the_later_object_is_there_alone(void **state)
{
    compare("\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " BOX(0.6, -0.6, 0.2, 1.2, RED) ", " SPHERE(
                0, -0.7, 0.3, 0.9,
                OBJECT_JOB_GLASS INTERIOR(
                    "\"sigma_s\": 0, \"sigma_a\": [0.5, 0.1, 0.3]")) ", " SPHERE(-0.6, -0.7, 0.9, 0.4,
                                                                                 OBJECT_JOB_MIRROR) "]",
            OBJECT_JOB_LIGHT ", " BACKGROUND, ROUNDING);
}

static void a_union_has_no_walls_inside(void **state)
{
    compare("\"objects\": [" OBJECT_JOB_FLOOR(
                OBJECT_JOB_GREY) ", {\"kind\": \"union\", \"of\": ["
                                 "{\"kind\": \"sphere\", \"center\": [-0.5, 0, 0], \"radius\": 0.7},"
                                 "{\"kind\": \"sphere\", \"center\": [0.5, 0.1, 0.2], \"radius\": 0.6},"
                                 "{\"kind\": \"box\", \"center\": [0, -0.5, 0], \"size\": [1, 1, 1]}], \"material\": "
                                 "{" OBJECT_JOB_GLASS INTERIOR("\"sigma_s\": 0, \"sigma_a\": [0.5, 0.1, 0.3]") "}}]",
            OBJECT_JOB_LIGHT ", " BACKGROUND, ROUNDING);
}

#define FOG(density)                                                                                                   \
    "\"media\": [{\"density\": {" density                                                                              \
    "}, \"sigma_s\": [0.1, 0.12, 0.15], \"sigma_a\": 0.02, \"phase\": [{\"g\": 0.4}]}], "

#define FOG_BALL "\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 3}"

static void fog_is_outside_only(void **state)
{
    compare(FOG(FOG_BALL) "\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " OBJECT_JOB_BALL(OBJECT_JOB_GLASS) "]",
            OBJECT_JOB_LIGHT, MARCHING);
}

static void smoke_is_inside_only(void **state)
{
    compare("\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " OBJECT_JOB_BALL(
                OBJECT_JOB_GLASS INTERIOR("\"sigma_s\": 2, \"sigma_a\": 0.1, \"density\": {\"kind\": \"homogeneous\", "
                                          "\"bounds\": {\"kind\": \"sphere\","
                                          " \"center\": [0.2, 0, 0.3], \"radius\": 0.9, \"falloff\": 0.3}}")) "]",
            OBJECT_JOB_LIGHT, MARCHING);
}

static void a_camera_may_be_in_glass(void **state)
{
    compare("\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " BOX(
                0.11, 0.07, 4.05, 2.5, OBJECT_JOB_GLASS INTERIOR("\"sigma_s\": 0.1, \"sigma_a\": [0.1, 0.2, 0.3]")) "]",
            OBJECT_JOB_LIGHT ", " BACKGROUND, ROUNDING);
}

#define TWO_LIGHTS                                                                                                     \
    "\"lights\": [{\"kind\": \"point\", \"intensity\": 10, \"position\": [1.5, 1, 1.5]}, {\"kind\": \"sun\","          \
    " \"direction\": [1, -2, -1], \"intensity\": [1, 0.8, 0.5]}]"
#define EQUIANGULAR "\"quality\": {\"method\": \"equiangular\", \"points\": 32}"

#define SMOKY_GLASS OBJECT_JOB_GLASS INTERIOR("\"sigma_s\": [1, 0.5, 0.2], \"sigma_a\": 0.1")

static void points_are_placed_in_every_region(void **state)
{
    compare_by(FOG(FOG_BALL) "\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " SPHERE(
                   -0.8, 0.1, 0, 0.7, SMOKY_GLASS) ", " SPHERE(0.8, 0.1, 0.3, 0.5, OBJECT_JOB_MIRROR) "]",
               TWO_LIGHTS, EQUIANGULAR, MARCHING);
}

// The box ends inside the ball and continues behind it: the smoke in the ball sees only the part that begins at the
// ball's surface.
static void smoke_does_not_see_what_its_glass_replaces(void **state)
{
    compare("\"objects\": [" BOX(0.7, 0.1, -0.2, 1.1, RED) ", " OBJECT_JOB_BALL(
                OBJECT_JOB_GLASS INTERIOR("\"sigma_s\": 1, \"sigma_a\": [0.1, 0.3, 0.5]")) "]",
            TWO_LIGHTS ", " BACKGROUND, MARCHING);
}

static void noise_drifts_around_glass(void **state)
{
    compare(
        FOG("\"kind\": \"noise\", \"octaves\": 1, \"frequency\": 0.7, \"scale\": 2, \"bounds\": {\"kind\": "
            "\"sphere\", \"center\": [0, 0, 0], \"radius\": 2}") "\"objects\": [" OBJECT_JOB_BALL(OBJECT_JOB_GLASS
                                                                                                      INTERIOR(
                                                                                                          "\"sigma_s\":"
                                                                                                          " 0, "
                                                                                                          "\"sigma_a\":"
                                                                                                          " 0.2")) "]",
        OBJECT_JOB_LIGHT, MARCHING);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(diffuse_objects_shade_one_another),
        cmocka_unit_test(a_diffuse_surface_has_a_specular_share),
        cmocka_unit_test(mirrors_reflect_mirrors),
        cmocka_unit_test(a_glass_ball_bends_what_is_behind),
        cmocka_unit_test(every_kind_of_fresnel_share),
        cmocka_unit_test(glass_within_glass),
        cmocka_unit_test(the_later_object_is_there_alone),
        cmocka_unit_test(a_union_has_no_walls_inside),
        cmocka_unit_test(fog_is_outside_only),
        cmocka_unit_test(smoke_is_inside_only),
        cmocka_unit_test(a_camera_may_be_in_glass),
        cmocka_unit_test(points_are_placed_in_every_region),
        cmocka_unit_test(smoke_does_not_see_what_its_glass_replaces),
        cmocka_unit_test(noise_drifts_around_glass),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
