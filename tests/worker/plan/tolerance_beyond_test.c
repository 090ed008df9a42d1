// Plans, and jobs that state their method, tell what their orders of scattering leave out, for a little of their work.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/assert_near.h"
#include "tests/support/gl_stage.h"
#include "worker/audit/beyond.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_beyond.h"
#include "worker/plan/plan_budget.h"
#include "worker/plan/tolerance.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { FRAMES = 3 };

static const char JOB[] =
    "{\"version\":1,\"name\":\"left out\",\"frames\":\"0-2\",\"fps\":24,\"resolution\":[64,48],"
    "\"camera\":{\"position\":[0.6,0.8,4],\"target\":[0,0,0],\"fov\":33},"
    "\"lights\":[{\"kind\":\"point\",\"position\":{\"keys\":[[0,[2,2.5,1.5]],[1,[2.5,2,1]]]},\"intensity\":20}],"
    "\"scene\":{\"scattering\":{\"orders\":%s},\"media\":[{\"density\":{\"kind\":\"homogeneous\",\"bounds\":{"
    "\"kind\":\"sphere\",\"radius\":1}},\"sigma_s\":3,\"sigma_a\":0.1}]},\"quality\":%s,"
    "\"output\":{\"path\":\"a.####.exr\",\"pixel\":\"float\"}}";

static void parse(struct job *job, const char *orders, const char *quality)
{
    struct error error = {{0}};
    char text[2048];

    snprintf(text, sizeof text, JOB, orders, quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

// The frames of a job with these orders and this quality.
static void render(const char *orders, const char *quality, struct job_beyond beyond[static FRAMES])
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct tolerance *tolerance = tolerance_create(stage.renderer);
    struct error error = {{0}};
    struct image image;
    struct job job;

    parse(&job, orders, quality);
    assert_true(image_init(&image, job.width_px, job.height_px, false, false, NULL));
    for (int i = 0; i < FRAMES; i++) {
        struct tolerance_result result;

        if (!tolerance_render(tolerance,
                              &(struct tolerance_params){.job = &job, .serial = 1, .frame = i, .image = &image},
                              &result, &error))
            fail_msg("%s", error.message);
        beyond[i] = result.beyond;
    }
    image_finish(&image);
    tolerance_destroy(tolerance);
    gl_stage_close(stage);
    job_finish(&job);
}

// By many paths, which tests/worker/audit/beyond_test compares with others.
static double find_truth(const char *orders, const char *quality)
{
    static const int32_t NUMBERS[FRAMES] = {0, 1, 2};
    struct job_beyond beyond;
    struct job job;

    parse(&job, orders, quality);
    assert_true(beyond_measure(
        &(struct beyond_params){.job = &job, .frames = NUMBERS, .frame_count = FRAMES, .draws_most = 1e9}, &beyond,
        NULL));
    assert_true(beyond.is_known);
    job_finish(&job);
    return beyond.error;
}

// Measured once, and the same whoever measures.
static void check(const char *orders, const char *quality, double allowed)
{
    struct job_beyond beyond[FRAMES], again[FRAMES];
    double truth = find_truth(orders, quality);

    render(orders, quality, beyond);
    render(orders, quality, again);
    printf("%s orders, %s: %.3g, at most %.3g, truly %.3g\n", orders, quality, beyond[0].error, beyond[0].error95,
           truth);
    assert_true(beyond[0].is_known && beyond[0].error95 >= truth);
    assert_near(beyond[0].error, truth, allowed * truth);
    for (int i = 0; i < FRAMES; i++) {
        assert_memory_equal(&beyond[i], &beyond[0], sizeof beyond[i]);
        assert_memory_equal(&again[i], &beyond[0], sizeof again[i]);
    }
}

static void a_plan_s_frames_tell_it(void **state)
{
    check("1", "{\"tolerance\":0.02}", 0.2);
    check("3", "{\"tolerance\":0.1}", 0.3);
}

static void frames_of_a_stated_method_tell_it(void **state)
{
    check("1", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1}", 0.2);
}

static void all_orders_leave_nothing_to_tell(void **state)
{
    struct job_beyond beyond[FRAMES];

    render("\"all\"", "{\"method\":\"paths\",\"paths\":4}", beyond);
    for (int i = 0; i < FRAMES; i++)
        assert_false(job_beyond_is_told(&beyond[i]));
}

// Evaluations of density that a draw takes as long as, with some room.
static void it_takes_two_percent_of_the_work_at_most(void **state)
{
    static const double DRAW = 40.0;

    for (double work = PLAN_LINK_WORK; work < 1e13; work = 10.0 * work + 1e6) {
        double allowed = DRAW * plan_beyond_find_limit(work);

        assert_true(allowed > 0.0 && allowed <= 0.02 * work * (1.0 + 1e-12));
        assert_true(allowed <= PLAN_LINK_WORK);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plan_s_frames_tell_it),
        cmocka_unit_test(frames_of_a_stated_method_tell_it),
        cmocka_unit_test(all_orders_leave_nothing_to_tell),
        cmocka_unit_test(it_takes_two_percent_of_the_work_at_most),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
