// What the modelled orders leave out, against a closed form and against many paths that end at the order.
// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/beyond.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/paths.h"
#include "tests/support/assert_near.h"
#include "tests/support/example_job.h"
#include "worker/audit/truth_files.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 16, HEIGHT_PX = 12, TRUTH_PATHS = 1 << 12 };

static const double MANY = 1e9;
static const char JOB[] = "{\"version\":1,\"name\":\"left out\",\"frames\":\"0-2\",\"fps\":24,\"resolution\":[16,12],"
                          "\"camera\":{\"position\":[0.6,0.8,4],\"target\":[0,0,0],\"fov\":33},"
                          "\"lights\":[{\"kind\":\"point\",\"position\":[2,2.5,1.5],\"intensity\":20}],"
                          "\"scene\":{\"scattering\":{\"orders\":%s},\"media\":[{\"density\":%s,%s}]},"
                          "\"quality\":{\"tolerance\":0.01},\"output\":{\"path\":\"a.####.exr\"}}";
static const char BALL[] = "{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}";
static const char NOISE[] = "{\"kind\":\"noise\",\"frequency\":1.5,\"octaves\":2,\"bounds\":{\"kind\":\"sphere\","
                            "\"radius\":1,\"falloff\":0.3}}";
static const char ENDLESS[] = "{\"kind\":\"homogeneous\"}";

static void parse(struct job *job, const char *orders, const char *density, const char *medium)
{
    struct error error = {{0}};
    char text[2048];

    snprintf(text, sizeof text, JOB, orders, density, medium);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static struct job_beyond measure(const struct job *job, double draws_most, double *drawn)
{
    static const int32_t FRAMES[] = {0, 1, 2};
    struct job_beyond beyond;

    assert_true(beyond_measure(
        &(struct beyond_params){.job = job, .frames = FRAMES, .frame_count = 3, .draws_most = draws_most}, &beyond,
        drawn));
    return beyond;
}

// Twice, independently: all light and that of the modelled orders, by paths that know nothing of parts. They begin with
// the same draws, so that they mostly differ by what is left out.
static double find_truth(const struct job *job)
{
    struct still *still = malloc(sizeof *still);
    double square = 0.0, all = 0.0;

    still_init(still, job, 0.0);
    for (int i = 0; i < WIDTH_PX * HEIGHT_PX; i++) {
        struct paths_light whole[2], modelled[2];

        for (int k = 0; k < 2; k++) {
            uint64_t seed = (uint64_t)(2 * i + k);

            assert_true(
                paths_measure_pixel(still, SCENE_ORDERS_ALL, i % WIDTH_PX, i / WIDTH_PX, TRUTH_PATHS, seed, &whole[k]));
            assert_true(paths_measure_pixel(still, job->scene.orders, i % WIDTH_PX, i / WIDTH_PX, TRUTH_PATHS, seed,
                                            &modelled[k]));
        }
        for (int c = 0; c < 3; c++) {
            square += (whole[0].mean[c] - modelled[0].mean[c]) * (whole[1].mean[c] - modelled[1].mean[c]);
            all += whole[0].mean[c] * whole[1].mean[c];
        }
    }
    free(still);
    return sqrt(fmax(square, 0.0) / all);
}

static void check(const char *orders, const char *density, const char *medium, double least, double most)
{
    struct job_beyond beyond;
    struct job job;
    double truth, drawn;

    parse(&job, orders, density, medium);
    truth = find_truth(&job);
    beyond = measure(&job, MANY, &drawn);
    printf("%s orders: truly %.3g, measured %.3g, at most %.3g, %.0f draws\n", orders, truth, beyond.error,
           beyond.error95, drawn);
    assert_true(truth > least && truth < most);
    assert_true(beyond.is_known && beyond.error95 >= truth);
    assert_near(beyond.error, truth, 0.04 * truth); // halves that are one are 8 % off, with three orders
    assert_true(beyond.error95 < 1.4 * truth);
    job_finish(&job);
}

static void a_thick_ball_leaves_most_out(void **state)
{
    check("1", BALL, "\"sigma_s\":[3,2.7,2],\"sigma_a\":0.1,\"phase\":[{\"g\":0.5}]", 0.7, 0.9);
    check("3", BALL, "\"sigma_s\":[3,2.7,2],\"sigma_a\":0.1,\"phase\":[{\"g\":0.5}]", 0.3, 0.5);
}

static void noise_leaves_much_out(void **state)
{
    check("1", NOISE, "\"sigma_s\":6,\"sigma_a\":0.2", 0.2, 0.8);
}

static void a_thin_ball_leaves_little_out(void **state)
{
    struct job_beyond beyond;
    struct job job;
    double truth;

    parse(&job, "1", BALL, "\"sigma_s\":0.02,\"sigma_a\":0");
    truth = find_truth(&job);
    beyond = measure(&job, MANY, NULL);
    printf("thin: truly %.3g, measured %.3g, at most %.3g\n", truth, beyond.error, beyond.error95);
    assert_true(truth > 0.005 && truth < 0.03);
    assert_true(beyond.is_known && beyond.error95 >= truth && beyond.error95 < 0.1);
    assert_near(beyond.error, truth, truth);
    job_finish(&job);
}

// Where all is alike, orders are a geometric series of the albedo.
static void an_endless_glow_leaves_a_power_of_its_albedo_out(void **state)
{
    static const char *const ORDERS[] = {"1", "2", "5"};

    for (int i = 0; i < 3; i++) {
        struct job_beyond beyond;
        struct job job;

        parse(&job, ORDERS[i], ENDLESS, "\"sigma_s\":0.6,\"sigma_a\":0.4,\"emission\":1");
        job.scene.light_count = 0;
        beyond = measure(&job, MANY, NULL);
        job.scene.light_count = 1;
        assert_true(beyond.is_known);
        assert_near(beyond.error, pow(0.6, job.scene.orders), 0.08 * pow(0.6, job.scene.orders));
        assert_true(beyond.error95 >= pow(0.6, job.scene.orders));
        job_finish(&job);
    }
}

static void assert_says(const struct job *job, double draws_most, const char *why)
{
    struct job_beyond beyond = measure(job, draws_most, NULL);

    assert_false(beyond.is_known);
    assert_string_equal(beyond.why, why);
}

static void what_paths_cannot_follow_is_told(void **state)
{
    struct job job;

    parse(&job, "1", ENDLESS, "\"sigma_s\":1,\"sigma_a\":0");
    assert_says(&job, MANY, "a medium without end absorbs nothing: its paths do not end");
    job_finish(&job);
    parse(&job, "1",
          "{\"kind\":\"glsl\",\"source\":\"float density(vec3 p) { return 1.0; }\",\"majorant\":1,"
          "\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}",
          "\"sigma_s\":1,\"sigma_a\":0");
    assert_says(&job, MANY, "a density in GLSL has no twin in the reference");
    job_finish(&job);
    parse(&job, "1", BALL, "\"sigma_s\":1,\"sigma_a\":0");
    job.scene.light_count = 0;
    assert_says(&job, MANY, "the frames that were looked at are black");
    job.scene.light_count = 1;
    job_finish(&job);
    example_job_load(&job, "mirror");
    job.scene.medium_count = 0;
    assert_says(&job, MANY, "the scene has no media");
    job_finish(&job);
    example_job_load(&job, "glass");
    assert_says(&job, MANY, "paths follow diffuse surfaces only");
    job_finish(&job);
}

static void what_is_not_left_out_needs_no_paths(void **state)
{
    struct job_beyond beyond;
    struct job job;
    double drawn;

    parse(&job, "\"all\"", BALL, "\"sigma_s\":1,\"sigma_a\":0");
    assert_false(job_beyond_is_told(&(struct job_beyond){0}));
    beyond = measure(&job, MANY, &drawn);
    assert_false(job_beyond_is_told(&beyond));
    assert_true(drawn == 0.0);
    job_finish(&job);
    parse(&job, "1", BALL, "\"sigma_s\":0,\"sigma_a\":1,\"emission\":1");
    beyond = measure(&job, MANY, &drawn);
    assert_true(beyond.is_known && beyond.error == 0.0 && beyond.error95 == 0.0 && drawn == 0.0);
    job_finish(&job);
}

// A path may give up only after a scattering.
static void the_draws_are_limited(void **state)
{
    static const double LIMITS[] = {1e2, 1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6};
    static const char *const MEDIA[] = {"\"sigma_s\":1,\"sigma_a\":0.1", "\"sigma_s\":200,\"sigma_a\":0"};
    int known = 0, unknown = 0;

    for (int i = 0; i < 16; i++) {
        struct job_beyond beyond;
        struct job job;
        double drawn;

        parse(&job, "1", NOISE, MEDIA[i / 8]);
        beyond = measure(&job, LIMITS[i % 8], &drawn);
        assert_true(drawn <= LIMITS[i % 8] + 1000.0);
        // Neither is the limit kept by drawing nothing.
        assert_true(!beyond.is_known || drawn > 0.2 * LIMITS[i % 8]);
        known += beyond.is_known;
        unknown += !beyond.is_known;
        if (!beyond.is_known) assert_string_equal(beyond.why, "measuring it takes too much work");
        job_finish(&job);
    }
    assert_true(known >= 3 && unknown >= 3);
}

static bool stop(void *user)
{
    return ++*(int *)user < 40;
}

static void it_can_be_stopped(void **state)
{
    static const int32_t FRAME = 0;
    struct job_beyond beyond;
    struct job job;
    int calls = 0;

    parse(&job, "1", BALL, "\"sigma_s\":1,\"sigma_a\":0");
    assert_false(beyond_measure(
        &(struct beyond_params){
            .job = &job, .frames = &FRAME, .frame_count = 1, .draws_most = MANY, .on_progress = stop, .user = &calls},
        &beyond, NULL));
    assert_int_equal(calls, 40);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_thick_ball_leaves_most_out),
        cmocka_unit_test(noise_leaves_much_out),
        cmocka_unit_test(a_thin_ball_leaves_little_out),
        cmocka_unit_test(an_endless_glow_leaves_a_power_of_its_albedo_out),
        cmocka_unit_test(what_paths_cannot_follow_is_told),
        cmocka_unit_test(what_is_not_left_out_needs_no_paths),
        cmocka_unit_test(the_draws_are_limited),
        cmocka_unit_test(it_can_be_stopped),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
