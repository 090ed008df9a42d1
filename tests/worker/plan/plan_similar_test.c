// Plans take similar media where phase functions are sharp, all orders count, and the tolerance leaves room.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "worker/plan/plan_similar.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static int after_of(const char *phase, const char *orders, const char *tolerance)
{
    struct error error = {{0}};
    struct job job;
    char text[1024];
    int after;

    snprintf(text, sizeof text,
             "{\"version\": 1, \"name\": \"a\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [8, 8],"
             " \"camera\": {\"position\": [0, 0, 4], \"target\": [0, 0, 0], \"fov\": 40},"
             " \"lights\": [{\"kind\": \"sun\", \"intensity\": 1, \"direction\": [0, -1, 0]}],"
             " \"scene\": {\"scattering\": {\"orders\": %s}, \"media\": [{\"sigma_s\": 9, \"phase\": [%s],"
             " \"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"radius\": 1}}}]},"
             " \"quality\": {\"tolerance\": %s}, \"output\": {\"path\": \"a.####.exr\"}}",
             orders, phase, tolerance);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    after = plan_similar_after(&job);
    job_finish(&job);
    return after;
}

static void similar_media_are_for_sharp_phases(void **state)
{
    (void)state;
    assert_int_equal(after_of("{\"g\": 0.85}", "\"all\"", "0.02"), 2);
    assert_int_equal(after_of("{\"g\": 0.95}", "\"all\"", "0.02"), 9);
    assert_int_equal(after_of("{\"g\": 0.3}", "\"all\"", "0.01"), 1);
    assert_int_equal(after_of("{\"g\": 0.9, \"weight\": 0.5}, {\"g\": -0.2, \"weight\": 0.5}", "\"all\"", "0.02"), 4);
    assert_int_equal(after_of("{\"g\": 0.29}", "\"all\"", "0.02"), 0);
    assert_int_equal(after_of("{\"g\": -0.85}", "\"all\"", "0.02"), 0);
    assert_int_equal(after_of("{\"kind\": \"rayleigh\"}", "\"all\"", "0.02"), 0);
    assert_int_equal(after_of("{\"g\": 0.85}", "1000", "0.02"), 0);
    assert_int_equal(after_of("{\"g\": 0.85}", "\"all\"", "0.0099"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(similar_media_are_for_sharp_phases)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
