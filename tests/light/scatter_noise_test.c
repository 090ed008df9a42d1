// Where walks from the nodes of a grid of scattered light go: their number, and the noise that they leave.
// SPDX-License-Identifier: Apache-2.0
// Noise is half the mean square of the difference of two pictures by independent walks, over the light's.
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

#include <cmocka.h>

#define BALL(COEFFICIENTS)                                                                                             \
    "{ " COEFFICIENTS ", \"density\": { \"kind\": \"homogeneous\","                                                    \
    " \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9 } } }"
#define DEEP BALL("\"sigma_s\": 30, \"sigma_a\": 0")
#define THIN BALL("\"sigma_s\": 0.05, \"sigma_a\": 0")
#define DEEPEST BALL("\"sigma_s\": 60, \"sigma_a\": 0")
#define SHARP BALL("\"sigma_s\": 12, \"sigma_a\": 0.01, \"phase\": [ { \"g\": 0.95 } ]")
#define SUN "{ \"kind\": \"sun\", \"intensity\": 3, \"direction\": [-1, -0.6, -0.4] },"
#define GRID                                                                                                           \
    "\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 32, \"scatter_grid\": 16, \"scatter_from\": \"nodes\""

struct found {
    double noise; // of one picture, relative
    double walks; // of one picture, over those that all nodes would have
};

static struct found measure(const char *media, const char *quality)
{
    const struct bias_check_scene scene = {
        .media = media, .lights = SUN, .orders = "\"all\"", .background = "0", .quality = quality};
    static const enum renderer_stream STREAMS[] = {RENDERER_STREAM_PICTURE, RENDERER_STREAM_PLAN_AGAIN};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct image images[2];
    struct found found;
    struct error error;
    struct job job;
    double noise = 0, light = 0;

    bias_check_parse(&job, &scene);
    for (int i = 0; i < 2; ++i) {
        assert_true(image_init(&images[i], BIAS_CHECK_WIDTH_PX, BIAS_CHECK_HEIGHT_PX, true, true, NULL));
        if (!renderer_render(
                stage.renderer,
                &(struct renderer_frame){.job = &job, .frame = 0, .stream = STREAMS[i], .image = &images[i]}, &result,
                &error))
            fail_msg("%s", error.message);
    }
    for (size_t i = 0; i < 4 * BIAS_CHECK_WIDTH_PX * BIAS_CHECK_HEIGHT_PX; ++i) {
        double a = images[0].rgba[i], b = images[1].rgba[i];

        if (i % 4 == 3) continue;
        noise += 0.5 * (a - b) * (a - b);
        light += a * b;
    }
    found.noise = sqrt(noise / light);
    found.walks = result.walks / (17.0 * 17.0 * 17.0 * job.quality.paths);
    print_message("noise %.4f, walks %.4f of all, %.1f steps each\n", found.noise, found.walks,
                  result.steps / result.walks);
    assert_true(result.steps >= 0.9 * result.walks); // each flies at least once
    image_finish(&images[0]);
    image_finish(&images[1]);
    job_finish(&job);
    gl_stage_close(stage);
    return found;
}

// The ball's far half and its inside are hidden. With all walks from all nodes that media surround, 0.61 of all, the
// noise is 0.034. The limits are twice what is found.
static void hidden_nodes_have_few_walks(void **state)
{
    struct found found = measure(DEEP, GRID ", \"paths\": 256");

    (void)state;
    assert_true(found.walks < 0.2);
    assert_true(found.noise < 0.07);
}

// What hides nothing is seen everywhere: only nodes about the rim show less, and have fewer walks.
static void nodes_of_thin_media_have_most_walks(void **state)
{
    (void)state;
    assert_true(measure(THIN, GRID ", \"paths\": 64").walks > 0.4);
}

// Some walks take thousands of steps: a turn of the program holds the longest.
static void long_walks_are_not_cut(void **state)
{
    (void)state;
    assert_true(measure(DEEPEST, GRID ", \"paths\": 32").noise < 0.2);
}

// A lamp in a narrow lobe's peak is met by few walks; those that look for it find it.
static void walks_look_for_lamps_in_sharp_lobes(void **state)
{
    (void)state;
    assert_true(measure(SHARP, GRID ", \"similar_after\": 8, \"paths\": 512").noise < 0.13);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hidden_nodes_have_few_walks),
        cmocka_unit_test(nodes_of_thin_media_have_most_walks),
        cmocka_unit_test(long_walks_are_not_cut),
        cmocka_unit_test(walks_look_for_lamps_in_sharp_lobes),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
