// SPDX-License-Identifier: Apache-2.0
#include "tests/support/object_job.h"

#include "core/base/error.h"
#include "core/job/job_json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

void object_job_parse(struct job *job, const char *scene, const char *rest)
{
    struct error error = {{0}};
    char text[8192];
    int length =
        snprintf(text, sizeof text,
                 "{\"version\": 1, \"name\": \"objects\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [48, 32],"
                 " \"camera\": {\"position\": [0, 0, 4], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 40, "
                 "\"clip\": [0, 100]},"
                 " \"scene\": {%s}, \"output\": {\"path\": \"objects.####.exr\", \"aovs\": [\"Z\", \"transmittance\"],"
                 " \"pixel\": \"float\"}, %s}",
                 scene, rest);

    assert_in_range(length, 1, sizeof text - 1);
    if (!job_parse(job, text, (size_t)length, NULL, &error)) fail_msg("%s", error.message);
}
