// Spheres and domes as random paths show them: closed forms first, then reference/ in media of every order.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "reference/paths.h"
#include "reference/still.h"
#include "tests/support/assert_near.h"
#include "tests/support/bias_check.h"
#include "tests/support/exr_maker.h"
#include "tests/support/gl_stage.h"
#include "tests/support/render_frame.h"
#include "tests/support/shader_dir.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

enum { PIXELS = BIAS_CHECK_WIDTH_PX * BIAS_CHECK_HEIGHT_PX };

#define BALL(MEMBERS)                                                                                                  \
    "{ " MEMBERS ", \"density\": { \"kind\": \"homogeneous\","                                                         \
    " \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9 } } }"
#define NOISE                                                                                                          \
    "{ \"sigma_s\": [2, 1, 3], \"sigma_a\": [0.2, 1, 0.5], \"phase\": [ { \"g\": 0.7, \"weight\": 0.8 },"              \
    " { \"kind\": \"rayleigh\", \"weight\": 0.2 } ], \"density\": { \"kind\": \"noise\", \"frequency\": 2.5,"          \
    " \"octaves\": 2, \"bias\": 0.2, \"mode\": \"clip\", \"scale\": 4,"                                                \
    " \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9, \"falloff\": 0.3 } } }"
#define EVEN_DOME "{ \"kind\": \"dome\", \"radiance\": 1 },"
#define VISIBLE "{ \"kind\": \"dome\", \"visible\": true, "
#define GRADIENT                                                                                                       \
    "{ \"kind\": \"dome\", \"gradient\": { \"along\": [0, 1, 3], \"against\": [2, 0.5, 0], \"axis\": [1, 2, -0.5] } "  \
    "},"
#define LAMP "{ \"kind\": \"sphere\", \"intensity\": [4, 2, 1], \"position\": [1.1, 0.9, 1], \"radius\": 0.5 },"
#define LAMP_INSIDE                                                                                                    \
    "{ \"kind\": \"sphere\", \"intensity\": [1, 3, 2], \"position\": [0.3, 0.1, -0.2], \"radius\": 0.3 },"
#define SUN "{ \"kind\": \"sun\", \"intensity\": [1, 2, 3], \"direction\": [1, -1, 1] },"
#define PATHS(COUNT) "\"method\": \"paths\", \"paths\": " COUNT

static void assert_fair(const struct bias_check_scene *scene, const double *truth, int frames)
{
    struct bias_check_errors errors = bias_check_measure(scene, truth, frames);

    assert_true(fabs(errors.sigmas) < 3.5);
    assert_true(errors.chance > 0.4 && errors.chance < 1.9);
    assert_true(errors.spread > 1e-3);
}

static struct ray ray_through(const struct still *still, int pixel)
{
    int column = pixel % BIAS_CHECK_WIDTH_PX, row = pixel / BIAS_CHECK_WIDTH_PX;

    return camera_pinhole_ray(&still->camera, column + 0.5, row + 0.5);
}

static double chord_of(const struct still *still, int pixel)
{
    struct ray ray = ray_through(still, pixel);
    double along = -vec3_dot(ray.origin, ray.direction);
    double square = 0.81 - vec3_dot(ray.origin, ray.origin) + along * along;

    return square > 0.0 ? 2.0 * sqrt(square) : 0.0;
}

// In uniform light a ball of albedo 1 sends out what its shadow takes away, whatever its phase function: all orders
// together are 1 - T. The fewer orders, the darker.
static void assert_furnace(const char *media, double sigma)
{
    const struct bias_check_scene scene = {
        .media = media, .lights = EVEN_DOME, .quality = PATHS("8"), .background = "0", .orders = "\"all\""};
    double truth[BIAS_CHECK_VALUES];
    struct still still;
    struct job job;

    bias_check_parse(&job, &scene);
    still_init(&still, &job, 0.0);
    for (int i = 0; i < BIAS_CHECK_VALUES; i++)
        truth[i] = 1.0 - exp(-sigma * chord_of(&still, i / 3));
    job_finish(&job);
    assert_fair(&scene, truth, 128);
}

static void white_balls_vanish_in_uniform_light(void **state)
{
    assert_furnace(BALL("\"sigma_s\": 0.5"), 0.5);
    assert_furnace(BALL("\"sigma_s\": 4, \"phase\": [ { \"g\": 0.85, \"weight\": 1 } ]"), 4.0);
    assert_furnace(BALL("\"sigma_s\": 3, \"phase\": [ { \"g\": -0.5, \"weight\": 0.4 },"
                        " { \"kind\": \"rayleigh\", \"weight\": 0.6 } ]"),
                   3.0);
}

// A thin ball in a dome of radiance 1 shows sigma_s times the ray's length in it.
// The sky behind is seen as bright as ever through such a ball.
static void white_balls_vanish_before_a_dome_that_is_seen(void **state)
{
    const struct bias_check_scene scene = {.media = BALL("\"sigma_s\": 2, \"phase\": [ { \"g\": 0.6 } ]"),
                                           .lights = VISIBLE "\"radiance\": 1 },",
                                           .quality = PATHS("8"),
                                           .background = "",
                                           .orders = "\"all\""};
    double truth[BIAS_CHECK_VALUES];

    for (int i = 0; i < BIAS_CHECK_VALUES; i++)
        truth[i] = 1.0;
    assert_fair(&scene, truth, 128);
}

static void assert_sky(const char *media)
{
    static const char gradient[] =
        VISIBLE "\"gradient\": { \"along\": [0, 1, 3], \"against\": [2, 0.5, 0], \"axis\": [1, 2, -0.5] } },";
    const struct bias_check_scene scene = {.media = media, .lights = gradient, .quality = PATHS("2"), .background = ""};
    struct still still;
    struct image image;
    struct job job;
    int count = 0;

    bias_check_parse(&job, &scene);
    still_init(&still, &job, 0.0);
    render_frame_zero(&job, &image);
    for (int i = 0; i < PIXELS; i++) {
        double wanted[3];

        if (chord_of(&still, i) > 0.0) continue;
        dome_radiance(&still.dome, ray_through(&still, i).direction, wanted);
        for (int c = 0; c < 3; c++)
            assert_near(image.rgba[4 * i + c], wanted[c], 1e-5);
        assert_true(image.rgba[4 * i + 3] == 1.0F);
        count++;
    }
    assert_true(count > 20);
    image_finish(&image);
    job_finish(&job);
}

// Where nothing is in front of a visible dome, it is all that is seen, and alpha is 1.
static void sky_is_seen_beside_media_and_without_any(void **state)
{
    assert_sky(BALL("\"sigma_s\": 2"));
    assert_sky(BALL("\"sigma_a\": 2"));
    assert_sky("{ \"sigma_s\": 1, \"density\": { \"kind\": \"homogeneous\","
               " \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 50, 0], \"radius\": 0.9 } } }");
}

static void thin_ball_shows_its_column_of_the_dome(void **state)
{
    const struct bias_check_scene scene = {.media = BALL("\"sigma_s\": [1e-4, 2e-4, 3e-4]"),
                                           .lights = EVEN_DOME,
                                           .quality = PATHS("2048"),
                                           .background = "0"};
    double truth[BIAS_CHECK_VALUES];
    struct still still;
    struct job job;

    bias_check_parse(&job, &scene);
    still_init(&still, &job, 0.0);
    for (int i = 0; i < BIAS_CHECK_VALUES; i++)
        truth[i] = 1e-4 * (i % 3 + 1) * chord_of(&still, i / 3);
    job_finish(&job);
    assert_fair(&scene, truth, 128);
}

static void find_truth(const struct bias_check_scene *scene, const struct still_inputs *inputs,
                       double truth[static BIAS_CHECK_VALUES])
{
    struct still still;
    struct job job;

    bias_check_parse(&job, scene);
    still_init_with_inputs(&still, &job, 0.0, inputs);
    assert_true(still.is_complete);
    for (int i = 0; i < PIXELS; i++) {
        struct paths_light light;

        assert_true(paths_measure_pixel(&still, job.scene.orders, i % BIAS_CHECK_WIDTH_PX, i / BIAS_CHECK_WIDTH_PX,
                                        8000, (uint64_t)i + 1, &light));
        for (int c = 0; c < 3; c++)
            truth[3 * i + c] = light.mean[c];
    }
    job_finish(&job);
}

static void assert_reference_with(const char *media, const char *lights, const char *orders,
                                  const struct still_inputs *inputs)
{
    const struct bias_check_scene scene = {
        .media = media, .lights = lights, .quality = PATHS("8"), .background = "0", .orders = orders};
    double truth[BIAS_CHECK_VALUES];

    find_truth(&scene, inputs, truth);
    assert_fair(&scene, truth, 64);
}

static void assert_reference(const char *media, const char *lights, const char *orders)
{
    static const struct still_inputs NOTHING;

    assert_reference_with(media, lights, orders, &NOTHING);
}

static void spheres_are_those_of_the_reference(void **state)
{
    assert_reference(NOISE, LAMP, "1");
    assert_reference(NOISE, LAMP SUN, "3");
    assert_reference(BALL("\"sigma_s\": [0.5, 1, 2]"), LAMP_INSIDE, "1");
    assert_reference(BALL("\"sigma_s\": [0.5, 1, 2], \"sigma_a\": 0.3"), LAMP_INSIDE, "\"all\"");
}

static void gradients_are_those_of_the_reference(void **state)
{
    assert_reference(NOISE, GRADIENT, "1");
    assert_reference(NOISE, GRADIENT LAMP, "4");
}

static void fill_sky(int width, int height, float *rgb)
{
    for (int i = 0; i < height * width; i++)
        for (int c = 0; c < 3; c++)
            rgb[3 * i + c] = (float)((i / width < height / 2 ? 0.5 : 0.1) * (1.0 + 0.3 * c) *
                                     (1.0 + 0.5 * sin(0.2 * (i % width) + c)));
}

// An image that turns and grows brighter is seen where it should be at each moment.
static void image_turns_as_it_should(void **state)
{
    enum { WIDTH = 64, HEIGHT = 32 };
    static float rgb[HEIGHT * WIDTH * 3];
    const struct still_inputs inputs = {.dome = {rgb, WIDTH, HEIGHT}};
    const char *path = temp_folder_path(state, "turning.exr");
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct bias_check_scene scene = {.media = BALL("\"sigma_s\": 2"), .quality = PATHS("1"), .background = ""};
    struct image image;
    struct job job;
    char light[512];

    fill_sky(WIDTH, HEIGHT, rgb);
    exr_maker_write(path, WIDTH, HEIGHT, JOB_PIXEL_FLOAT, rgb);
    snprintf(light, sizeof light,
             VISIBLE "\"file\": \"%s\", \"scale\": { \"start\": 1, \"rate\": 0.5 },"
                     " \"rotate\": { \"axis\": { \"start\": [1, 3, 0.5], \"rate\": [0.1, 0, 0.3] },"
                     " \"angle\": { \"start\": 20, \"rate\": 360 } } },",
             path);
    scene.lights = light;
    bias_check_parse(&job, &scene);
    assert_true(image_init(&image, BIAS_CHECK_WIDTH_PX, BIAS_CHECK_HEIGHT_PX, true, true, NULL));
    for (int32_t frame = 0; frame < 24; frame += 5) {
        struct renderer_result result;
        struct still still;

        still_init_with_inputs(&still, &job, job_frame_time(&job, frame), &inputs);
        assert_true(renderer_render(
            stage.renderer, &(struct renderer_frame){.job = &job, .frame = frame, .image = &image}, &result, NULL));
        for (int i = 0; i < PIXELS; i++) {
            double wanted[3];

            if (chord_of(&still, i) > 0.0) continue;
            dome_radiance(&still.dome, ray_through(&still, i).direction, wanted);
            // Angles are rounded to some 1e-6, of 0.1 for a texel.
            for (int c = 0; c < 3; c++)
                assert_near(image.rgba[4 * i + c], wanted[c], 1e-4);
        }
    }
    image_finish(&image);
    gl_stage_close(stage);
    job_finish(&job);
}

// A sky whose sun is one texel, 1e5 times as bright as the rest.
static void images_are_those_of_the_reference(void **state)
{
    enum { WIDTH = 64, HEIGHT = 32 };
    static float rgb[HEIGHT * WIDTH * 3];
    struct still_inputs inputs = {.dome = {rgb, WIDTH, HEIGHT}};
    const char *path = temp_folder_path(state, "sky.exr");
    char light[512];

    fill_sky(WIDTH, HEIGHT, rgb);
    for (int c = 0; c < 3; c++)
        rgb[3 * (7 * WIDTH + 40) + c] = 1e5F / (float)(c + 1);
    exr_maker_write(path, WIDTH, HEIGHT, JOB_PIXEL_FLOAT, rgb);
    snprintf(light, sizeof light,
             "{ \"kind\": \"dome\", \"file\": \"%s\", \"scale\": [0.5, 1, 2],"
             " \"rotate\": { \"axis\": [1, 3, 0.5], \"angle\": 70 } },",
             path);
    assert_reference_with(NOISE, light, "1", &inputs);
    assert_reference_with(NOISE, light, "\"all\"", &inputs);
    assert_reference_with(BALL("\"sigma_s\": [1, 2, 3]"), light, "2", &inputs);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(white_balls_vanish_in_uniform_light),
        cmocka_unit_test(white_balls_vanish_before_a_dome_that_is_seen),
        cmocka_unit_test(sky_is_seen_beside_media_and_without_any),
        cmocka_unit_test(thin_ball_shows_its_column_of_the_dome),
        cmocka_unit_test(spheres_are_those_of_the_reference),
        cmocka_unit_test(gradients_are_those_of_the_reference),
        cmocka_unit_test_setup_teardown(image_turns_as_it_should, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(images_are_those_of_the_reference, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
