// Rays, cameras and lights exactly on faces of media, and endless media: finite pictures, and the few known values.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/render_frame.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define MIDPOINT "\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.05"
#define EQUIANGULAR "\"method\": \"equiangular\", \"points\": 9"
#define BOX ", \"bounds\": { \"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [2, 2, 2] }"
#define SLAB ", \"bounds\": { \"kind\": \"slab\", \"center\": [0, 0, 0], \"normal\": [0, 1, 0], \"thickness\": 2 }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": 2, \"direction\": [0, -1, 0] }"

enum { SIDE_PX = 5, MIDDLE = SIDE_PX * (SIDE_PX / 2) + SIDE_PX / 2 };

// The camera looks along z. The ray of its middle pixel is exactly along z.
static struct image render(double y, double z, const char *lights, const char *bounds, const char *medium,
                           const char *quality)
{
    struct error error = {{0}};
    struct image image;
    struct job job;
    char text[2048];

    snprintf(
        text, sizeof text,
        "{ \"version\": 1, \"name\": \"edge\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [%d, %d],"
        " \"camera\": { \"position\": [0, %g, %g], \"target\": [0, %g, %g], \"up\": [0, 1, 0], \"fov\": 40 },"
        " \"lights\": [ %s ], \"scene\": { \"media\": [ { \"density\": { \"kind\": \"homogeneous\"%s }, %s } ] },"
        " \"quality\": { %s }, \"output\": { \"path\": \"edge.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
        SIDE_PX, SIDE_PX, y, z, y, z + 10, lights, bounds, medium, quality);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    render_frame_zero(&job, &image);
    assert_true(image_is_finite(&image, false, NULL));
    for (int i = 0; i < 4 * SIDE_PX * SIDE_PX; ++i)
        assert_true(image.rgba[i] >= 0);
    job_finish(&job);
    return image;
}

static void endless_fog_under_a_sun_is_black(void **state)
{
    struct image image = render(0, 0, SUN, "", "\"sigma_s\": 0.1", EQUIANGULAR);

    for (int i = 0; i < SIDE_PX * SIDE_PX; ++i) {
        assert_true(image.rgba[4 * i] == 0 && image.rgba[4 * i + 3] == 1);
        assert_true(fabs(image.depth[i] / (log(2) / 0.1) - 1) < 0.15);
    }
    image_finish(&image);
}

static void endless_glow_is_emission_over_absorption(void **state)
{
    struct image image = render(0, 0, "", "", "\"sigma_a\": 7, \"emission\": 7", EQUIANGULAR);

    for (int i = 0; i < SIDE_PX * SIDE_PX; ++i)
        assert_true(fabs(image.rgba[4 * i] - 1) < 1e-6);
    image_finish(&image);
}

static void a_camera_in_a_face_sees_the_medium_in_front_of_it(void **state)
{
    struct image image = render(0, -1, "", BOX, "\"sigma_a\": 1", MIDPOINT);

    assert_true(fabs(image.transmittance[4 * MIDDLE] - exp(-2)) < 1e-6);
    image_finish(&image);
    image = render(0, 1, "", BOX, "\"sigma_a\": 1", MIDPOINT);
    assert_true(fabs(image.transmittance[4 * MIDDLE] - 1) < 1e-6);
    image_finish(&image);
}

// The camera looks along the face y = 1.
static void a_ray_in_a_face_is_finite(void **state)
{
    static const char *const qualities[] = {MIDPOINT, EQUIANGULAR};

    for (int i = 0; i < 2; ++i) {
        struct image image = render(1, -3, SUN, BOX, "\"sigma_s\": 1", qualities[i]);

        image_finish(&image);
    }
}

static void a_ray_along_a_slab_has_no_end(void **state)
{
    struct image image = render(0.5, 0, SUN, SLAB, "\"sigma_s\": 0.5", EQUIANGULAR);
    double pi = 3.14159265358979323846;

    // The sun's light passes half a metre of the slab, and is scattered along the endless ray.
    assert_true(fabs(image.rgba[4 * MIDDLE] - 2 * exp(-0.25) / (4 * pi)) < 1e-5);
    assert_true(image.transmittance[4 * MIDDLE] == 0);
    image_finish(&image);
}

static void a_light_on_a_ray_is_finite(void **state)
{
    static const char *const positions[] = {"0, 0, -3", "0, 0, 0", "0, 0, 5", "0, 0, -1", "0, 0, -9"};
    static const char *const qualities[] = {MIDPOINT, EQUIANGULAR};

    for (int i = 0; i < 5 * 2; ++i) {
        char light[128];
        struct image image;

        snprintf(light, sizeof light, "{ \"kind\": \"point\", \"intensity\": 1, \"position\": [%s] }",
                 positions[i / 2]);
        image = render(0, -3, light, BOX, "\"sigma_s\": 0.5, \"phase\": [ { \"g\": 0.9 } ]", qualities[i % 2]);
        assert_true(image.rgba[4 * MIDDLE] > 0);
        image_finish(&image);
    }
}

static void a_light_at_the_camera_in_fog_is_finite(void **state)
{
    struct image image = render(0, 0, "{ \"kind\": \"point\", \"intensity\": 1, \"position\": [0, 0, 0] }", "",
                                "\"sigma_s\": 0.5", EQUIANGULAR);

    assert_true(image.rgba[4 * MIDDLE] > 0);
    image_finish(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(endless_fog_under_a_sun_is_black),
        cmocka_unit_test(endless_glow_is_emission_over_absorption),
        cmocka_unit_test(a_camera_in_a_face_sees_the_medium_in_front_of_it),
        cmocka_unit_test(a_ray_in_a_face_is_finite),
        cmocka_unit_test(a_ray_along_a_slab_has_no_end),
        cmocka_unit_test(a_light_on_a_ray_is_finite),
        cmocka_unit_test(a_light_at_the_camera_in_fog_is_finite),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
