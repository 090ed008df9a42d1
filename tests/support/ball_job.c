// SPDX-License-Identifier: Apache-2.0
#include "tests/support/ball_job.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

void ball_job_parse(struct job *job, const char *medium, const char *rest)
{
    struct error error = {{0}};
    char *text;
    bool ok;

    // Without an offset the folds keep distances from the origin, and an exponent near 0 makes the density constant: 1
    // to within 2e-4, except in the outermost micrometre.
    text = xasprintf(
        "{\"version\": 1, \"name\": \"ball\", \"frames\": \"0-9\", \"fps\": 24, \"resolution\": [48, 32],"
        " \"camera\": {\"position\": [0, 0, 4], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 40, \"clip\": [1, "
        "8]},"
        " \"scene\": {\"media\": [{\"density\": {\"kind\": \"fold_fractal\", \"iterations\": 2, \"offset\": 0, "
        "\"radius\": 1,"
        " \"rotate_x_rad\": 0.3, \"rotate_y_rad\": 0.2, \"exponent\": 1e-5, \"scale\": 1}, %s}]},"
        " \"output\": {\"path\": \"ball.####.exr\", \"pixel\": \"float\", \"aovs\": [\"Z\", \"transmittance\"]}, %s}",
        medium, rest);
    ok = job_parse(job, text, strlen(text), NULL, &error);
    free(text);
    if (!ok) fail_msg("%s", error.message);
}
