// A lipschitz that is too low, in a job that states a tolerance.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/ball_job.h"
#include "tests/support/tolerance_stage.h"
#include "worker/picture/image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// A shell of slope 20 around a hollow, in a constant scene, with the lipschitz that its code promises.
static struct job shell_job(double lipschitz)
{
    struct error error = {{0}};
    struct job job;
    char text[1024];
    int length = snprintf(
        text, sizeof text,
        "{\"version\":1,\"name\":\"shell\",\"frames\":\"0-9\",\"fps\":24,\"resolution\":[48,32],"
        "\"camera\":{\"position\":[0,0,4],\"target\":[0,0,0],\"up\":[0,1,0],\"fov\":40},%s,"
        "\"scene\":{\"media\":[{\"density\":{\"kind\":\"glsl\",\"source\":\"float density(vec3 p, float t) { return "
        "20.0 * (0.12 - abs(length(p) - 0.7)); }\",\"lipschitz\":%g,\"bounds\":{\"kind\":\"sphere\",\"radius\":1}},"
        "\"sigma_s\":1,\"sigma_a\":0}]},\"quality\":{\"tolerance\":0.05},\"output\":{\"path\":\"s.####.exr\"}}",
        BALL_JOB_POINT_LIGHT, lipschitz);

    if (!job_parse(&job, text, (size_t)length, NULL, &error)) fail_msg("%s", error.message);
    return job;
}

static void a_promise_that_is_too_low_is_not_believed(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job broken = shell_job(2), job = shell_job(20);
    struct tolerance_result result;
    struct error error = {{0}};
    struct image image;

    assert_false(tolerance_stage_render(stage, &broken, 0, &image, &result, &error));
    print_message("%s\n", error.message);
    assert_int_equal(result.render.fault, RENDERER_FAULT_MISSED);
    assert_non_null(strstr(error.message, "lipschitz"));
    image_finish(&image);
    tolerance_stage_close(stage);
    stage = tolerance_stage_open(NULL);
    if (!tolerance_stage_render(stage, &job, 0, &image, &result, &error)) fail_msg("%s", error.message);
    image_finish(&image);
    job_finish(&broken);
    job_finish(&job);
    tolerance_stage_close(stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_promise_that_is_too_low_is_not_believed),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
