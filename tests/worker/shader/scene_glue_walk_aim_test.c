// Which paths turn towards lamps.
// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk_aim.h"

#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/ball_job.h"
#include "tests/support/shader_text.h"
#include "worker/shader/scene_program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// A ball of radius 1 m.
static void parse(struct job *job, const char *medium, const char *lights)
{
    struct error error = {{0}};
    char text[1024];

    snprintf(text, sizeof text,
             "{\"version\": 1, \"name\": \"even\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [48, 32],"
             " \"camera\": {\"position\": [0, 0, 4], \"target\": [0, 0, 0], \"fov\": 40}, \"scene\": {\"media\": ["
             "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"radius\": 1}}, %s}]},"
             " \"output\": {\"path\": \"even.####.exr\"}, %s, \"quality\": {\"method\": \"paths\", \"paths\": 4}}",
             medium, lights);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

// Where media scatter widely or are thick, looks for lamps would only take time.
static void narrow_lobes_of_thin_media_aim_at_lamps(void **state)
{
    static const struct {
        const char *medium, *lights;
        int orders;
        bool aims;
    } cases[] = {
        {"\"sigma_s\": 2, \"phase\": [{\"g\": 0.7}]", BALL_JOB_POINT_LIGHT, 2, true},
        {"\"sigma_s\": 2, \"phase\": [{\"g\": 0.7}]", BALL_JOB_POINT_LIGHT, 1, false},
        {"\"sigma_s\": 2, \"phase\": [{\"g\": 0.6}]", BALL_JOB_POINT_LIGHT, 2, false},
        {"\"sigma_s\": 2, \"sigma_a\": 1.5, \"phase\": [{\"g\": 0.7}]", BALL_JOB_POINT_LIGHT, 2, false},
        {"\"sigma_s\": 2, \"phase\": [{\"g\": 0.7}]", "\"lights\": [{\"kind\": \"dome\", \"radiance\": 1}]", 2, false},
    };

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene_program program;
        struct error error = {{0}};
        struct job job;

        parse(&job, cases[i].medium, cases[i].lights);
        job.scene.orders = cases[i].orders;
        if (!scene_program_init(&program, &job, NULL, NULL, &error)) fail_msg("%s", error.message);
        (cases[i].aims ? shader_text_assert_has : shader_text_assert_lacks)(&program, "walk_aim_draw(");
        scene_program_finish(&program);
        job_finish(&job);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(narrow_lobes_of_thin_media_aim_at_lamps),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
