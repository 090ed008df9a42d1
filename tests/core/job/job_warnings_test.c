// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_warnings.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void append(void *user, const char *text)
{
    strcat(user, text);
    strcat(user, "\n");
}

// The warnings about a job with this medium and quality, camera at (0, 0, 4), which looks at the origin.
static void assert_warnings(const char *medium, const char *quality, const char *expected)
{
    char *text =
        xasprintf("{\"version\":1,\"name\":\"x\",\"frames\":\"0-9\",\"fps\":1,\"resolution\":[32,18],\"camera\":{"
                  "\"position\":[0,0,4],\"target\":[0,0,0],\"fov\":40,\"clip\":[1,9]},\"scene\":{\"media\":[%s]},"
                  "\"quality\":%s,\"output\":{\"path\":\"x/x.#.exr\"}}",
                  medium, quality);
    char found[1024] = "";
    struct error error;
    struct job job;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    job_warnings_find(&job, append, found);
    assert_string_equal(found, expected);
    job_finish(&job);
    free(text);
}

#define BALL(center)                                                                                                   \
    "{\"sigma_s\":1,\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"center\":" center          \
    ",\"radius\":1}}}"
#define UNSEEN "scene.media[0]: no frame shows it: it lies outside of the camera's view or of its clip distances\n"

static void a_medium_that_no_frame_shows_is_told(void **state)
{
    static const char fine[] = "{\"tolerance\":0.01}";

    assert_warnings(BALL("[0,0,0]"), fine, "");
    assert_warnings(BALL("[0,0,8]"), fine, UNSEEN);                           // behind
    assert_warnings(BALL("[0,0,-7]"), fine, UNSEEN);                          // beyond clip
    assert_warnings(BALL("[0,2.4,0]"), fine, "");                             // 4 tan 20 = 1.46, and the ball's side
    assert_warnings(BALL("[0,2.6,0]"), fine, UNSEEN);                         // above
    assert_warnings(BALL("[3.5,0,0]"), fine, "");                             // wider than high
    assert_warnings(BALL("[4.2,0,0]"), fine, UNSEEN);                         // beside
    assert_warnings(BALL("{\"start\":[9,0,0],\"rate\":[-1,0,0]}"), fine, ""); // in its last frames
    assert_warnings("{\"sigma_s\":1,\"density\":{\"kind\":\"homogeneous\"}}", fine, "");
    assert_warnings(
        "{\"sigma_s\":1,\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"box\",\"center\":[0,9,0],"
        "\"size\":[1,1,1]}}}",
        fine, UNSEEN);
}

static void a_tolerance_in_percent_is_told(void **state)
{
    assert_warnings(BALL("[0,0,0]"), "{\"tolerance\":0.5}",
                    "quality.tolerance: 0.5 is an error of 50 %; 0.005 is one of 0.5 %\n");
    assert_warnings(BALL("[0,0,0]"), "{\"tolerance\":0.2}", "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_medium_that_no_frame_shows_is_told),
        cmocka_unit_test(a_tolerance_in_percent_is_told),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
