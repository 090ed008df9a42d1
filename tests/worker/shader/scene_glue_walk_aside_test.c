// Where vertices of random paths send second paths towards lamps.
// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk_aside.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/ball_job.h"
#include "tests/support/shader_text.h"
#include "worker/shader/scene_program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define DOME "\"lights\": [{\"kind\": \"dome\", \"radiance\": 1}]"
#define FLOOR                                                                                                          \
    "\"objects\": [{\"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": "    \
    "1}}],"

static void parse(struct job *job, const char *objects, double g, const char *lights)
{
    struct error error = {{0}};
    char text[1024];

    snprintf(text, sizeof text,
             "{\"version\": 1, \"name\": \"even\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [48, 32],"
             " \"camera\": {\"position\": [0, 0, 4], \"target\": [0, 0, 0], \"fov\": 40}, \"scene\": {%s \"media\": ["
             "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"radius\": 1}},"
             " \"sigma_s\": 2, \"phase\": [{\"g\": %g}]}]}, \"output\": {\"path\": \"even.####.exr\"}, %s,"
             " \"quality\": {\"method\": \"paths\", \"paths\": 4}}",
             objects, g, lights);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

// Elsewhere they would only take time, and behind surfaces their odds are not known.
static void narrow_lobes_without_surfaces_send_second_paths(void **state)
{
    static const struct {
        double g;
        const char *objects, *lights;
        int orders;
        bool sends;
    } cases[] = {
        {0.75, "", BALL_JOB_POINT_LIGHT, 2, true},
        {0.7, "", BALL_JOB_POINT_LIGHT, 2, false},
        {0.9, "", BALL_JOB_POINT_LIGHT, 1, false},
        {0.9, FLOOR, BALL_JOB_POINT_LIGHT, 2, false},
        {-0.95, "", BALL_JOB_POINT_LIGHT, 2, true},
        {-0.9, "", BALL_JOB_POINT_LIGHT, 2, false},
        {0.9, "", DOME, 2, false},
    };

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene_program program;
        struct error error = {{0}};
        struct job job;

        parse(&job, cases[i].objects, cases[i].g, cases[i].lights);
        job.scene.orders = cases[i].orders;
        if (!scene_program_init(&program, &job, NULL, NULL, &error)) fail_msg("%s", error.message);
        (cases[i].sends ? shader_text_assert_has : shader_text_assert_lacks)(&program, "walk_aside_chance(");
        scene_program_finish(&program);
        job_finish(&job);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(narrow_lobes_without_surfaces_send_second_paths),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
