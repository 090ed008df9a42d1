// How often the bound on what is left out holds in scenes, with as few draws as a single small frame has.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "worker/audit/beyond.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { TRIALS = 100, TRUTHS = 8 };

static const double FEW = 3e4, MORE = 1.2e5, MANY = 1e9;
static const char JOB[] = "{\"version\":1,\"name\":\"left out\",\"frames\":\"0\",\"fps\":24,\"resolution\":[160,120],"
                          "\"camera\":{\"position\":[0.6,0.8,4],\"target\":[0,0,0],\"fov\":33},"
                          "\"lights\":[{\"kind\":\"point\",\"position\":%s,\"intensity\":20}],"
                          "\"scene\":{\"media\":[{\"density\":%s,%s}]},"
                          "\"quality\":{\"tolerance\":0.01},\"output\":{\"path\":\"a.####.exr\"}}";
static const char BALL[] = "{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}";
static const char NOISE[] = "{\"kind\":\"noise\",\"frequency\":1.5,\"octaves\":2,\"bounds\":{\"kind\":\"sphere\","
                            "\"radius\":1,\"falloff\":0.3}}";
static const char FOG[] = "{\"kind\":\"homogeneous\"}";
static const char BESIDE[] = "[2,2.5,1.5]", INSIDE[] = "[0.3,0.2,0.1]";

static struct job_beyond measure(const struct job *job, double draws_most, uint64_t seed)
{
    static const int32_t FRAME = 0;
    struct job_beyond beyond;

    assert_true(beyond_measure(
        &(struct beyond_params){.job = job, .frames = &FRAME, .frame_count = 1, .draws_most = draws_most, .seed = seed},
        &beyond, NULL));
    return beyond;
}

static void check(const char *name, const char *lamp, const char *density, const char *medium, double draws_most)
{
    double square = 0.0, bounds = 0.0, errors = 0.0;
    struct error error = {{0}};
    char text[2048];
    struct job job;
    int held = 0, known = 0;

    snprintf(text, sizeof text, JOB, lamp, density, medium);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    for (int i = 0; i < TRUTHS; i++)
        square += pow(measure(&job, MANY, (uint64_t)(1000 + i)).error, 2.0) / TRUTHS;
    for (int i = 0; i < TRIALS; i++) {
        struct job_beyond beyond = measure(&job, draws_most, (uint64_t)(i + 1));

        known += beyond.is_known;
        held += beyond.is_known && beyond.error95 >= sqrt(square);
        bounds += beyond.error95;
        errors += pow(beyond.error, 2.0);
    }
    errors = sqrt(errors / known);
    printf("%s: truly %.3g; %d of %d known, RMS of the errors %.3g, mean bound %.3g, held in %d\n", name, sqrt(square),
           known, TRIALS, errors, bounds / known, held);
    assert_true(known >= 0.9 * TRIALS && held >= 0.93 * known);
    assert_true(fabs(errors - sqrt(square)) < 0.2 * sqrt(square));
    job_finish(&job);
}

static void the_bound_holds_beside_lamps(void **state)
{
    check("thick ball", BESIDE, BALL, "\"sigma_s\":3,\"sigma_a\":0.1", FEW);
    check("thin ball", BESIDE, BALL, "\"sigma_s\":0.2,\"sigma_a\":0.1", FEW);
    check("forward noise", BESIDE, NOISE, "\"sigma_s\":3,\"sigma_a\":0.1,\"phase\":[{\"g\":0.8}]", FEW);
}

// Light grows as 1 / r^2 about the lamp: pixels near it have most of the light.
static void the_bound_holds_about_lamps(void **state)
{
    check("lamp in a ball", INSIDE, BALL, "\"sigma_s\":2,\"sigma_a\":0.1", FEW);
    check("lamp in thin fog", INSIDE, FOG, "\"sigma_s\":0.1,\"sigma_a\":0.1", MORE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bound_holds_beside_lamps),
        cmocka_unit_test(the_bound_holds_about_lamps),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
