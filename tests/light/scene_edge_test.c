// Rays through a homogeneous ball on which a sample, a light or an early stop is at an edge.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "tests/support/ball_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

struct seen {
    float rgba[4];
    float depth;
};

// The one pixel's ray enters the ball at 3 m and leaves it at 5 m. A job that integrates by riemann takes steps of 0.5
// m.
static struct seen see_middle(const char *medium, const char *rest, double near, double far)
{
    struct error error = {{0}};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, test_shader_dir());
    struct renderer_result result;
    struct image image;
    struct seen seen;
    struct job job;

    ball_job_parse(&job, medium, rest);
    job.width_px = job.height_px = 1;
    job.scene.camera.clip_near = near;
    job.scene.camera.clip_far = far;
    if (job.quality.method == JOB_METHOD_RIEMANN) job.quality.step = 0.5;
    assert_true(image_init(&image, 1, 1, true, true, NULL));
    if (!renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image}, &result,
                         &error))
        fail_msg("%s", error.message);
    memcpy(seen.rgba, image.rgba, sizeof seen.rgba);
    seen.depth = image.depth[0];
    assert_true(image_is_finite(&image, false, NULL));
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
    return seen;
}

// The interval is 2.5 steps long. The count is rounded in double precision, a half away from 0; a driver may round a
// float either way. A sample stands for the step that ends there, so half of the light is left ln 2 m behind the near
// distance.
static void a_riemann_sum_has_the_samples_its_interval_gives(void **state)
{
    struct seen seen = see_middle(BALL_JOB_SIGMA_A_1, BALL_JOB_RIEMANN, 3, 4.25);

    // 2e-4: the density differs from 1 by that much.
    assert_true(fabs(seen.rgba[3] - (1 - exp(-3 * 0.5))) < 2e-4);
    assert_true(fabs(seen.depth - (3 + log(2))) < 2e-4);
}

// The second sample lies at exactly the light's position.
static void a_light_at_a_sample_is_finite(void **state)
{
    static const char *const falloffs[] = {"none", "inverse_square"};

    for (int i = 0; i < 2; ++i) {
        char rest[256];
        struct seen seen;

        snprintf(rest, sizeof rest,
                 "\"lights\": [{\"kind\": \"point\", \"falloff\": \"%s\", \"intensity\": 1,"
                 " \"position\": [0, 0, 0]}], " BALL_JOB_RIEMANN,
                 falloffs[i]);
        seen = see_middle(BALL_JOB_SIGMA_S_1 ", \"phase\": [{\"g\": 0.5}]", rest, 3, 5);
        assert_true(seen.rgba[0] > 0);
    }
}

static void media_are_gathered_between_the_clip_distances(void **state)
{
    struct seen seen = see_middle(BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT, 3.51, 4.27);

    assert_true(fabs(seen.rgba[3] - (1 - exp(-0.76))) < 2e-4);
    assert_true(fabs(seen.depth - (3.51 + log(2))) < 2e-4);
}

// The sum runs from its only sample, half a metre deep, to where the medium ends: beyond, there is nothing to sum.
static void a_riemann_sum_towards_a_sun_ends_with_the_media(void **state)
{
    struct seen seen = see_middle(
        BALL_JOB_SIGMA_S_1,
        "\"lights\": [{\"kind\": \"sun\", \"direction\": [0, 0, -1], \"intensity\": 1}], " BALL_JOB_RIEMANN, 3, 3.5);

    assert_true(fabs(seen.rgba[0] - 0.5 * exp(-0.5) / (4 * 3.14159265358979323846)) < 1e-5);
}

static void a_ray_goes_on_while_any_colour_passes(void **state)
{
    struct seen seen = see_middle("\"sigma_a\": [0, 50, 50], \"emission\": 1",
                                  "\"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.05, "
                                  "\"min_transmittance\": 0.5}",
                                  1, 8);

    // Two metres glow, less the density's difference from 1 and a step at either end.
    assert_true(fabs(seen.rgba[0] - 2) < 1e-3);
    assert_true(fabs(seen.rgba[1] - 1.0 / 50) < 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_riemann_sum_has_the_samples_its_interval_gives),
        cmocka_unit_test(a_light_at_a_sample_is_finite),
        cmocka_unit_test(media_are_gathered_between_the_clip_distances),
        cmocka_unit_test(a_riemann_sum_towards_a_sun_ends_with_the_media),
        cmocka_unit_test(a_ray_goes_on_while_any_colour_passes),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
