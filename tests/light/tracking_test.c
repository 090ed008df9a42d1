// Tracking: exact cases, refused cases, majorants that are too low, pictures that are the same whoever renders them.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/bias_check.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define BALL "\"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9 }"
#define NOISE(COEFFICIENTS, SCALE)                                                                                     \
    "{ " COEFFICIENTS ", \"density\": { \"kind\": \"noise\", \"frequency\": 2.5, \"octaves\": 3,"                      \
    " \"mode\": \"clip\", \"scale\": " SCALE ", " BALL " } }"
#define CODE(SOURCE, MAJORANT)                                                                                         \
    "{ \"sigma_s\": 1, \"sigma_a\": 1, \"density\": { \"kind\": \"glsl\", \"scale\": 3, \"majorant\": " MAJORANT       \
    ", \"source\": \"float density(vec3 p, float t) { return " SOURCE "; }\", " BALL " } }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": 3, \"direction\": [-1, -2, 0.5] },"
#define RATIO "\"method\": \"tracking\", \"estimator\": \"ratio\""
#define DELTA "\"method\": \"tracking\", \"estimator\": \"delta\""
#define DEBIASED "\"method\": \"tracking\", \"estimator\": \"debiased\", \"step\": 0.2, \"light_step\": 0.2"

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

static bool render(struct stage *stage, int32_t frame)
{
    return renderer_render(stage->gl.renderer,
                           &(struct renderer_frame){.job = &stage->job, .frame = frame, .image = &stage->image},
                           &stage->result, &stage->error);
}

static void assert_even(const struct bias_check_scene *scene, float wanted, float tolerance)
{
    struct stage stage = open_stage(scene, BIAS_CHECK_HEIGHT_PX);

    if (!render(&stage, 7)) fail_msg("%s", stage.error.message);
    for (int i = 0; i < BIAS_CHECK_VALUES; ++i)
        if (fabsf(stage.image.rgba[i / 3 * 4 + i % 3] - wanted) > tolerance)
            fail_msg("%s: %.9g", scene->quality, (double)stage.image.rgba[i / 3 * 4 + i % 3]);
    close_stage(&stage);
}

// Each collision emits as much as it absorbs.
static void a_furnace_is_one(void **state)
{
    static const char media[] = NOISE("\"sigma_s\": 0, \"sigma_a\": [1, 3, 0.2], \"emission\": [1, 3, 0.2]", "9");

    (void)state;
    assert_even(&(struct bias_check_scene){.media = media, .background = "1", .quality = RATIO}, 1.0f, 2e-5f);
    assert_even(&(struct bias_check_scene){.media = NOISE("\"sigma_s\": 0, \"sigma_a\": 2, \"emission\": 2", "9"),
                                           .background = "1",
                                           .quality = DELTA},
                1.0f, 1e-6f);
}

static void empty_media_change_nothing(void **state)
{
    static const char *const qualities[] = {RATIO, DELTA, DEBIASED};
    static const char media[] = CODE("-1.0", "1") "," NOISE("\"sigma_s\": 1, \"sigma_a\": 0", "1e-30");

    (void)state;
    for (size_t i = 0; i < sizeof qualities / sizeof *qualities; ++i)
        assert_even(
            &(struct bias_check_scene){.media = media, .lights = SUN, .background = "0.5", .quality = qualities[i]},
            0.5f, 0.0f);
}

static void assert_too_low(const char *media, const char *quality, const char *place)
{
    const struct bias_check_scene scene = {.media = media, .lights = SUN, .quality = quality};
    struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);

    assert_false(render(&stage, 3));
    assert_int_equal(stage.result.fault, RENDERER_FAULT_MAJORANT);
    print_message("%s\n", stage.error.message);
    assert_non_null(strstr(stage.error.message, place));
    close_stage(&stage);
}

// The density is up to 1 in the ball's middle.
static void majorants_too_low_fail_the_frame(void **state)
{
    static const char fine[] = CODE("1.0 - length(p)", "1"), low[] = CODE("1.0 - length(p)", "0.8");
    char both[2048];

    (void)state;
    assert_too_low(low, RATIO, "scene.media[0].density.majorant: expected an upper bound of density()");
    assert_too_low(low, DELTA, "got 0.8, which it exceeds");
    snprintf(both, sizeof both, "%s, %s", fine, low);
    assert_too_low(both, RATIO, "scene.media[1].density.majorant");
    // Few of many samples meet the excess.
    assert_too_low(CODE("length(p.xy) < 0.02 ? 1.1 : 0.5", "1"), RATIO ", \"samples\": 256", "scene.media[0]");
}

static void majorants_that_hold_fail_nothing(void **state)
{
    const struct bias_check_scene scene = {.media = CODE("1.0 - length(p)", "1"), .lights = SUN, .quality = RATIO};
    struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);

    (void)state;
    for (int32_t frame = 0; frame < 20; ++frame)
        if (!render(&stage, frame)) fail_msg("%s", stage.error.message);
    close_stage(&stage);
}

// The picture depends neither on the renderer nor on what it rendered before, by which it chooses its tiles. The random
// numbers of one frame do not affect another's.
static void a_frame_is_the_same_picture_for_all(void **state)
{
    static const char *const qualities[] = {RATIO, DELTA, DEBIASED};

    (void)state;
    for (size_t i = 0; i < sizeof qualities / sizeof *qualities; ++i) {
        const struct bias_check_scene scene = {
            .media = NOISE("\"sigma_s\": 2, \"sigma_a\": 1", "2"), .lights = SUN, .quality = qualities[i]};
        // The picture has more rows than a renderer's first tile.
        struct stage alone = open_stage(&scene, 96), busy = open_stage(&scene, 96);
        size_t bytes = 4 * BIAS_CHECK_WIDTH_PX * 96 * sizeof *alone.image.rgba;

        assert_true(render(&alone, 5));
        assert_true(render(&busy, 3) && render(&busy, 4));
        assert_memory_not_equal(busy.image.rgba, alone.image.rgba, bytes);
        assert_true(render(&busy, 5));
        assert_memory_equal(busy.image.rgba, alone.image.rgba, bytes);
        close_stage(&alone);
        close_stage(&busy);
    }
}

// A ray's transmittance is its own estimate, and its depth is where that falls to one half.
static void depth_and_transmittance_follow_the_estimate(void **state)
{
    const struct bias_check_scene scene = {.media = NOISE("\"sigma_s\": 0, \"sigma_a\": 3", "9"), .quality = DELTA};
    struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX);
    int ended = 0;

    (void)state;
    assert_true(render(&stage, 1));
    for (int i = 0; i < BIAS_CHECK_VALUES / 3; ++i) {
        float left = stage.image.transmittance[4 * i], depth = stage.image.depth[i];

        assert_true(left == 0.0f || left == 1.0f);
        assert_float_equal(stage.image.rgba[4 * i], 0.3f * left, 1e-6f);
        if (left == 1.0f) assert_true(depth == 0.0f);
        if (left == 0.0f) assert_true(depth > 3.0f && depth < 5.0f);
        ended += left == 0.0f;
    }
    assert_true(ended > BIAS_CHECK_VALUES / 30);
    close_stage(&stage);
}

// Optical depths reach some thousands: rays of little transmittance end at random. The search for a collision has no
// end where a majorant of 1e5 stands over nothing.
static void thick_media_come_to_an_end(void **state)
{
    static const char *const qualities[] = {RATIO, DELTA};

    (void)state;
    for (size_t i = 0; i < sizeof qualities / sizeof *qualities; ++i) {
        const struct bias_check_scene scene = {
            .media = NOISE("\"sigma_s\": 1, \"sigma_a\": 1", "2e3"), .lights = SUN, .quality = qualities[i]};
        const struct bias_check_scene endless = {
            .media = NOISE("\"sigma_s\": 1, \"sigma_a\": 1", "1e6"), .lights = SUN, .quality = qualities[i]};
        struct stage stage = open_stage(&scene, BIAS_CHECK_HEIGHT_PX),
                     stuck = open_stage(&endless, BIAS_CHECK_HEIGHT_PX);

        if (!render(&stage, 0)) fail_msg("%s", stage.error.message);
        assert_true(image_is_finite(&stage.image, true, NULL));
        assert_false(render(&stuck, 0));
        assert_int_equal(stuck.result.fault, RENDERER_FAULT_ENDLESS);
        assert_non_null(strstr(stuck.error.message, "expected thinner media, or a GPU"));
        close_stage(&stage);
        close_stage(&stuck);
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_furnace_is_one),
        cmocka_unit_test(empty_media_change_nothing),
        cmocka_unit_test(majorants_too_low_fail_the_frame),
        cmocka_unit_test(majorants_that_hold_fail_nothing),
        cmocka_unit_test(a_frame_is_the_same_picture_for_all),
        cmocka_unit_test(depth_and_transmittance_follow_the_estimate),
        cmocka_unit_test(thick_media_come_to_an_end),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
