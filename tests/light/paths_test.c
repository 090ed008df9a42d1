// Random paths: pictures that are the same whoever renders them, in however many slices; thick media; alpha and depth.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/bias_check.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/picture/pixel.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define BALL "\"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9 }"
#define NOISE                                                                                                          \
    "{ \"sigma_s\": [2, 3, 4], \"sigma_a\": 0.5, \"density\": { \"kind\": \"noise\", \"frequency\": 2.5,"              \
    " \"octaves\": 3, \"mode\": \"clip\", \"scale\": 6, " BALL " } }"
#define EVEN(COEFFICIENTS) "{ " COEFFICIENTS ", \"density\": { \"kind\": \"homogeneous\", " BALL " } }"
#define LAMP "{ \"kind\": \"point\", \"intensity\": 3, \"position\": [0.2, 0.3, 0.1] },"
#define SUN "{ \"kind\": \"sun\", \"intensity\": 3, \"direction\": [-1, -2, 0.5] },"
#define PATHS(COUNT) "\"method\": \"paths\", \"paths\": " COUNT

enum { HEIGHT_PX = 96 }; // more rows than a renderer's first tile

struct stage {
    struct gl_stage gl;
    struct image image;
    struct job job;
    struct renderer_result result;
    struct error error;
};

static struct stage open_stage(const struct bias_check_scene *scene, int height_px)
{
    struct stage stage = {0};

    bias_check_parse(&stage.job, scene);
    stage.job.height_px = height_px;
    stage.gl = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    assert_true(image_init(&stage.image, BIAS_CHECK_WIDTH_PX, height_px, true, true, NULL));
    return stage;
}

static void close_stage(struct stage *stage)
{
    image_finish(&stage->image);
    gl_stage_close(stage->gl);
    job_finish(&stage->job);
}

static void render_stream(struct stage *stage, int32_t frame, enum renderer_stream stream)
{
    if (!renderer_render(
            stage->gl.renderer,
            &(struct renderer_frame){.job = &stage->job, .frame = frame, .stream = stream, .image = &stage->image},
            &stage->result, &stage->error))
        fail_msg("%s", stage->error.message);
}

static void render(struct stage *stage, int32_t frame)
{
    render_stream(stage, frame, RENDERER_STREAM_PICTURE);
}

// Tiles follow from what a renderer has drawn before, and pixels of a list share SIMD units with others than in the
// frame: slices end at other turns.
static void a_frame_is_the_same_picture_for_all(void **state)
{
    static const char *const qualities[] = {PATHS("3"), PATHS("200"), PATHS("40") ", \"samples\": 2"};

    (void)state;
    for (size_t i = 0; i < sizeof qualities / sizeof *qualities; ++i) {
        const struct bias_check_scene scene = {
            .media = NOISE, .lights = SUN LAMP, .orders = "\"all\"", .quality = qualities[i]};
        struct stage alone = open_stage(&scene, HEIGHT_PX), busy = open_stage(&scene, HEIGHT_PX);
        size_t bytes = (size_t)4 * BIAS_CHECK_WIDTH_PX * HEIGHT_PX * sizeof *alone.image.rgba;

        render(&alone, 5);
        render(&busy, 3);
        assert_memory_not_equal(busy.image.rgba, alone.image.rgba, bytes);
        render(&busy, 5);
        assert_memory_equal(busy.image.rgba, alone.image.rgba, bytes);
        close_stage(&alone);
        close_stage(&busy);
    }
}

static void a_list_has_the_pixels_of_the_frame(void **state)
{
    enum { COUNT = 37 };
    const struct bias_check_scene scene = {.media = NOISE, .lights = SUN, .orders = "\"all\"", .quality = PATHS("100")};
    struct stage whole = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);
    struct pixel pixels[COUNT];
    struct image list;

    (void)state;
    render(&whole, 2);
    for (int i = 0; i < COUNT; ++i)
        pixels[i] = (struct pixel){(7 * i + 3) % BIAS_CHECK_WIDTH_PX, (5 * i + 1) % BIAS_CHECK_HEIGHT_PX};
    assert_true(image_init(&list, COUNT, 1, true, true, NULL));
    if (!renderer_render(whole.gl.renderer,
                         &(struct renderer_frame){
                             .job = &whole.job, .frame = 2, .pixels = pixels, .pixel_count = COUNT, .image = &list},
                         &whole.result, &whole.error))
        fail_msg("%s", whole.error.message);
    for (int i = 0; i < COUNT; ++i) {
        size_t at = (size_t)pixels[i].y * BIAS_CHECK_WIDTH_PX + (size_t)pixels[i].x;

        assert_memory_equal(list.rgba + 4 * (size_t)i, whole.image.rgba + 4 * at, 4 * sizeof *list.rgba);
    }
    image_finish(&list);
    close_stage(&whole);
}

// Renders all pixels as a list.
static double count_steps_of_list(struct stage *stage)
{
    enum { COUNT = BIAS_CHECK_WIDTH_PX * BIAS_CHECK_HEIGHT_PX };
    struct pixel pixels[COUNT];
    struct image list;

    for (int i = 0; i < COUNT; ++i)
        pixels[i] = (struct pixel){i % BIAS_CHECK_WIDTH_PX, i / BIAS_CHECK_WIDTH_PX};
    assert_true(image_init(&list, COUNT, 1, true, true, NULL));
    if (!renderer_render(stage->gl.renderer,
                         &(struct renderer_frame){
                             .job = &stage->job, .frame = 5, .pixels = pixels, .pixel_count = COUNT, .image = &list},
                         &stage->result, &stage->error))
        fail_msg("%s", stage->error.message);
    image_finish(&list);
    return stage->result.steps;
}

// The same paths take as many steps in a list; ten times as many paths take ten times as many.
static void steps_of_paths_are_counted(void **state)
{
    static const char *const qualities[] = {PATHS("50"), PATHS("500")};
    double steps[2];

    (void)state;
    for (int i = 0; i < 2; ++i) {
        const struct bias_check_scene scene = {
            .media = NOISE, .lights = SUN, .orders = "\"all\"", .quality = qualities[i], .background = ""};
        struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);
        double listed;

        render(&stage, 5);
        steps[i] = stage.result.steps;
        listed = count_steps_of_list(&stage);
        print_message("%.0f steps in a frame, %.0f in a list\n", steps[i], listed);
        assert_true(fabs(listed / steps[i] - 1.0) < 0.05);
        close_stage(&stage);
    }
    assert_true(steps[0] >= 50 * 0.5 * BIAS_CHECK_WIDTH_PX * BIAS_CHECK_HEIGHT_PX);
    assert_true(fabs(steps[1] / steps[0] - 10.0) < 1.0);
}

// Renders a picture, and what a plan looks at. Returns the share of the lit values that are the same in both.
static double share_alike(const char *quality)
{
    enum { VALUES = 4 * BIAS_CHECK_WIDTH_PX * BIAS_CHECK_HEIGHT_PX };
    const struct bias_check_scene scene = {
        .media = NOISE, .lights = SUN, .orders = "\"all\"", .quality = quality, .background = ""};
    struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);
    float picture[VALUES], again[VALUES];
    double lit = 0, alike = 0, difference = 0, sum = 0;

    render(&stage, 5);
    memcpy(picture, stage.image.rgba, sizeof picture);
    render_stream(&stage, 5, RENDERER_STREAM_PLAN);
    for (size_t i = 0; i < VALUES; ++i) {
        float value = stage.image.rgba[i];

        if (i % 4 == 3 || picture[i] <= 0.0f || value <= 0.0f) continue;
        lit += 1;
        alike += picture[i] == value;
        difference += (double)(value - picture[i]);
        sum += (double)picture[i];
    }
    render_stream(&stage, 5, RENDERER_STREAM_PICTURE);
    memcpy(again, stage.image.rgba, sizeof again);
    assert_memory_equal(again, picture, sizeof picture);
    assert_true(lit > 50);
    assert_true(fabs(difference) < 0.2 * sum);
    close_stage(&stage);
    return alike / lit;
}

// Else a plan would choose the numbers of paths by the picture's luck.
static void a_plan_draws_other_paths(void **state)
{
    (void)state;
    assert_true(share_alike(PATHS("64")) < 0.05);
    assert_true(share_alike("\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.1, \"scatter_grid\": 8,"
                            " \"paths\": 64") < 0.05);
}

// No light is lost in a white medium, however thick: most of it comes back, and paths have thousands of scatterings.
// The ball reflects at most what falls onto it, I / pi for a sun of irradiance I, as a white Lambertian ball would.
static void thick_white_media_come_to_an_end(void **state)
{
    const struct bias_check_scene scene = {.media = EVEN("\"sigma_s\": 100, \"sigma_a\": 0"),
                                           .lights = SUN,
                                           .orders = "\"all\"",
                                           .background = "0",
                                           .quality = PATHS("16")};
    struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);
    double sum = 0, most = 0;

    (void)state;
    render(&stage, 0);
    for (size_t i = 0; i < BIAS_CHECK_VALUES / 3; ++i) {
        sum += (double)stage.image.rgba[4 * i];
        most = fmax(most, (double)stage.image.rgba[4 * i]);
    }
    assert_true(image_is_finite(&stage.image, true, NULL));
    print_message("mean %.3f, most %.3f\n", sum / (BIAS_CHECK_VALUES / 3), most);
    // The brightest pixels see the lit side nearly along the light, which sends back 3 / pi in the mean.
    assert_true(most > 0.5 && most < 1.6);
    close_stage(&stage);
}

// White media of optical depth 1e3 vanish in even light: a ray that meets the ball sees what comes from everywhere.
// Paths are as long as chance wants, some of them a million of scatterings, and none of them is cut.
static void the_thickest_white_media_lose_no_light(void **state)
{
    const struct bias_check_scene scene = {.media = EVEN("\"sigma_s\": 560, \"sigma_a\": 0"),
                                           .lights = "{ \"kind\": \"dome\", \"radiance\": 1 },",
                                           .orders = "\"all\"",
                                           .background = "",
                                           .quality = PATHS("16")};
    struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);
    double sum = 0, squares = 0, count = 0;

    (void)state;
    render(&stage, 0);
    for (size_t i = 0; i < BIAS_CHECK_VALUES / 3; ++i) {
        double value = (double)stage.image.rgba[4 * i];

        if (stage.image.rgba[4 * i + 3] < 1.0f) continue;
        sum += value;
        squares += value * value;
        ++count;
    }
    print_message("mean %.4f, a pixel's deviation %.3f, %g pixels\n", sum / count,
                  sqrt(squares / count - sum * sum / count / count), count);
    assert_true(count > 20);
    assert_true(fabs(sum / count - 1) < 4 * sqrt((squares / count - sum * sum / count / count) / count));
    close_stage(&stage);
}

// One path may be as long as a hundred others: it is followed for as long as it takes, over hundreds of slices.
static void a_single_path_may_be_long(void **state)
{
    const struct bias_check_scene scene = {.media = EVEN("\"sigma_s\": 5600, \"sigma_a\": 0"),
                                           .lights = "{ \"kind\": \"dome\", \"radiance\": 1 },",
                                           .orders = "\"all\"",
                                           .background = "",
                                           .quality = PATHS("1")};
    struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);

    (void)state;
    for (int32_t frame = 0; frame < 12; ++frame)
        render(&stage, frame);
    close_stage(&stage);
}

// The transmittance of media that vary, if only at their bounds, is within the noise of 256 estimates of a white one.
static void transmittance_is_that_of_the_medium(void **state)
{
    const struct bias_check_scene scene = {
        .media = "{ \"sigma_s\": 0.2, \"sigma_a\": [0.8, 0.3, 0.1], \"density\": { \"kind\": \"homogeneous\","
                 " \"bounds\": { \"kind\": \"sphere\", \"radius\": 0.9, \"falloff\": 0.001 } } }",
        .lights = SUN,
        .orders = "3",
        .background = "1",
        .quality = PATHS("1024")};
    struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);
    size_t middle = (size_t)(BIAS_CHECK_HEIGHT_PX / 2) * BIAS_CHECK_WIDTH_PX + BIAS_CHECK_WIDTH_PX / 2;
    const float *passed = stage.image.transmittance + 4 * middle;

    (void)state;
    render(&stage, 0);
    assert_float_equal(passed[0], exp(-1.75), 0.1);
    assert_float_equal(passed[1], exp(-0.5 * 1.75), 0.1);
    assert_float_equal(passed[2], exp(-0.3 * 1.75), 0.1);
    close_stage(&stage);
}

// What lies behind is weighed by estimates whose noise falls with the number of paths, however many.
static void noise_falls_before_a_bright_background(void **state)
{
    struct bias_check_scene scene = {
        .media = NOISE, .lights = SUN, .orders = "2", .background = "10", .quality = PATHS("64")};
    double truth[BIAS_CHECK_VALUES], few, many;

    (void)state;
    for (size_t i = 0; i < BIAS_CHECK_VALUES; ++i)
        truth[i] = 1; // noise alone is looked at
    few = bias_check_measure(&scene, truth, 32).spread * sqrt(64) * sqrt(32.0 / 31);
    scene.quality = PATHS("8192");
    many = bias_check_measure(&scene, truth, 8).spread * sqrt(8192) * sqrt(8.0 / 7);
    print_message("noise of a path: %.2f of few, %.2f of many\n", few, many);
    assert_true(many < 1.25 * few);
}

// Alpha and transmittance are those of the medium, and depth is so within the noise of 256 estimates of a white one.
static void alpha_and_depth_are_those_of_the_medium(void **state)
{
    const struct bias_check_scene scene = {.media = EVEN("\"sigma_s\": 0.2, \"sigma_a\": [0.8, 0.3, 0.1]"),
                                           .lights = SUN,
                                           .orders = "3",
                                           .background = "1",
                                           .quality = PATHS("1024")};
    struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);
    size_t middle = (size_t)(BIAS_CHECK_HEIGHT_PX / 2) * BIAS_CHECK_WIDTH_PX + BIAS_CHECK_WIDTH_PX / 2;
    const float *passed = stage.image.transmittance + 4 * middle;

    (void)state;
    render(&stage, 0);
    // The ray through that pixel is 1.75 m or so long in the ball. Homogeneous media have a closed form.
    assert_float_equal(passed[0], exp(-1.75), 0.02);
    assert_float_equal(passed[1], pow(passed[0], 0.5), 1e-5);
    assert_float_equal(passed[2], pow(passed[0], 0.3), 1e-5);
    assert_float_equal(stage.image.rgba[4 * middle + 3], 1.0f, 0.0f);
    assert_true(stage.image.depth[middle] > 3.1f && stage.image.depth[middle] < 5.0f);
    assert_float_equal(stage.image.transmittance[0], 1.0f, 0.0f);
    assert_float_equal(stage.image.depth[0], 0.0f, 0.0f);
    close_stage(&stage);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_is_the_same_picture_for_all),
        cmocka_unit_test(a_list_has_the_pixels_of_the_frame),
        cmocka_unit_test(steps_of_paths_are_counted),
        cmocka_unit_test(a_plan_draws_other_paths),
        cmocka_unit_test(thick_white_media_come_to_an_end),
        cmocka_unit_test(the_thickest_white_media_lose_no_light),
        cmocka_unit_test(a_single_path_may_be_long),
        cmocka_unit_test(transmittance_is_that_of_the_medium),
        cmocka_unit_test(noise_falls_before_a_bright_background),
        cmocka_unit_test(alpha_and_depth_are_those_of_the_medium),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
