// Plans for scenes of wide extents with something small and dense in them.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/render_frame.h"
#include "tests/support/tolerance_stage.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double TOLERANCE = 0.02;

// A ball in front of a floor, in a mist that reaches as far as the camera sees: 60 m, but rays end after some 2 m.
static struct job mist_job(const char *density, const char *quality)
{
    struct error error = {{0}};
    struct job job;
    char text[2048];
    int length = snprintf(
        text, sizeof text,
        "{\"version\":1,\"name\":\"mist\",\"frames\":\"0\",\"fps\":24,\"resolution\":[64,36],"
        "\"camera\":{\"position\":[0,0.8,0.8],\"target\":[0,0,0],\"up\":[0,1,0],\"fov\":35,\"clip\":[0,60]},"
        "\"lights\":[{\"kind\":\"sun\",\"direction\":[-1,-1,-0.5],\"intensity\":3}],"
        "\"scene\":{\"media\":["
        "{\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"slab\",\"center\":[0,0,0],\"thickness\":4}},"
        "\"sigma_s\":0.002},"
        "{\"density\":{%s,\"bounds\":{\"kind\":\"sphere\",\"radius\":0.25}},\"sigma_s\":30,\"sigma_a\":3}],"
        "\"objects\":[{\"kind\":\"plane\",\"point\":[0,-0.4,0],\"material\":{\"kind\":\"diffuse\",\"albedo\":0.1}}]},"
        "\"quality\":{%s},\"output\":{\"path\":\"s.####.exr\",\"pixel\":\"float\",\"aovs\":[\"Z\",\"transmittance\"]}}",
        density, quality);

    if (!job_parse(&job, text, (size_t)length, NULL, &error)) fail_msg("%s", error.message);
    return job;
}

static void assert_kept(const struct job *job, struct image *image)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct tolerance_result result;
    struct error error = {{0}};

    if (!tolerance_stage_render(stage, job, 0, image, &result, &error)) fail_msg("%s", error.message);
    print_message("error %.2e of %g after %d misses: %s\n", result.audit.error, TOLERANCE, result.retry_count,
                  result.reason);
    assert_int_equal(result.retry_count, 0);
    tolerance_stage_close(stage);
}

static void a_small_cloud_in_wide_mist_is_resolved(void **state)
{
    struct job job =
        mist_job("\"kind\":\"noise\",\"frequency\":8,\"octaves\":2,\"H\":0.7,\"mode\":\"clip\"", "\"tolerance\":0.02");
    struct image image;

    (void)state;
    assert_kept(&job, &image);
    image_finish(&image);
    job_finish(&job);
}

// Two renders in steps that are longer than the ball are equal, and nothing else measures the user's code.
static void own_code_in_wide_mist_is_resolved(void **state)
{
    static const char RINGS[] = "\"kind\":\"glsl\",\"source\":\"float density(vec3 p, float t) { return "
                                "0.5 + 0.5 * sin(40.0 * length(p - vec3(0.1, 0.1, 0.0))); }\"";
    struct job job = mist_job(RINGS, "\"tolerance\":0.02");
    struct job fine = mist_job(RINGS, "\"method\":\"midpoint\",\"step\":0.005,\"light_step\":0.005");
    double difference = 0.0, light = 0.0;
    struct image image, truth;

    (void)state;
    assert_kept(&job, &image);
    render_frame_zero(&fine, &truth);
    for (size_t i = 0; i < 4 * 64 * 36; i++) {
        if (i % 4 == 3) continue;
        difference += pow((double)image.rgba[i] - truth.rgba[i], 2.0);
        light += pow(truth.rgba[i], 2.0);
    }
    print_message("truly %.2e\n", sqrt(difference / light));
    assert_true(sqrt(difference / light) <= TOLERANCE);
    image_finish(&truth);
    image_finish(&image);
    job_finish(&fine);
    job_finish(&job);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_small_cloud_in_wide_mist_is_resolved),
        cmocka_unit_test(own_code_in_wide_mist_is_resolved),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
