// Light that is lost with cut rays in a few dark pixels: an audit draws them more often, so its bound covers the loss.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/object_job.h"
#include "tests/support/tolerance_stage.h"
#include "tests/support/true_error.h"
#include "worker/audit/audit.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_family.h"
#include "worker/render/renderer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { AUDITS = 100, FRAMES = 20 };

#define BOX(center, size, material)                                                                                    \
    "{\"kind\": \"box\", \"center\": [" center "], \"size\": [" size "], \"material\": {" material "}}"

// A black wall below the sky. A camera ray that meets the lower mirror is sent to the upper one, and from there to the
// sky: one reflection more than the job follows.
static struct job mirrors_job(void)
{
    struct job job;

    object_job_parse(&job,
                     "\"objects\": [" BOX("0, -1, -1", "8, 3, 0.1", "\"kind\": \"diffuse\", \"albedo\": 0") ", " BOX(
                         "0.5, -0.6, 0", "0.4, 0.1, 1", OBJECT_JOB_MIRROR) ", " BOX("0.5, -0.2, -0.55", "0.4, 0.8, 0.1",
                                                                                    OBJECT_JOB_MIRROR) "]",
                     "\"background\": 1, \"quality\": {\"tolerance\": 0.05, \"max_depth\": 1}");
    return job;
}

// The coarsest setting that a plan of the job may have: it follows rays as far as the job says.
static struct job_quality coarsest_quality(const struct job *job)
{
    struct plan_scene scene;
    size_t family = 0;

    plan_scene_init(&scene, job);
    while (!plan_family_serves(&plan_families[family], &scene))
        family++;
    return plan_family_quality(&plan_families[family], &scene, &(struct plan_point){.rungs = {0}});
}

static struct image draw(struct gl_stage stage, const struct job *job)
{
    struct renderer_result result;
    struct error error = {{0}};
    struct image image;

    if (!image_init_for_job(&image, job, &error) || !image_ask_cut(&image, &error) ||
        !renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .image = &image}, &result, &error))
        fail_msg("%s", error.message);
    return image;
}

// How many of AUDITS audits, each in other pixels, have a bound that holds.
static int count_covered(struct job *job, const struct image *image, const struct truth *truth, double truly)
{
    int covered = 0;

    for (int i = 0; i < AUDITS; i++) {
        struct audit_result result;

        snprintf(job->hash, sizeof job->hash, "audit %d", i);
        assert_true(audit_frame(
            &(struct audit_params){.job = job, .image = image, .truth = truth, .tolerance = job->quality.tolerance},
            &result));
        covered += result.error95 >= truly;
    }
    return covered;
}

static void lost_light_is_noticed(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct job job = mirrors_job(), planned = job;
    struct error error = {{0}};
    struct truth *truth;
    struct image image, bare;
    double truly;
    int covered, covered_bare;

    (void)state;
    planned.quality = coarsest_quality(&job);
    planned.quality.tolerance = job.quality.tolerance;
    image = draw(stage, &planned);
    truth = truth_open(&(struct truth_params){.job = &planned}, &error);
    if (!truth) fail_msg("%s", error.message);
    truly = true_error_measure(&planned, 0, &image);
    covered = count_covered(&planned, &image, truth, truly);
    bare = image;
    bare.cut = NULL;
    covered_bare = count_covered(&planned, &bare, truth, truly);
    print_message("truly %.3f: the bound holds in %d of %d, in %d where cut rays are not known\n", truly, covered,
                  AUDITS, covered_bare);
    assert_true(truly > 0.1);
    assert_true(covered >= 0.95 * AUDITS);
    assert_true(covered_bare < 0.7 * AUDITS); // else the scene shows nothing
    truth_close(truth);
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
}

// The audits of a tolerance know the cut rays.
static void a_frame_that_loses_light_is_no_good_one(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct job job = mirrors_job();
    const struct job_quality quality = coarsest_quality(&job);
    struct image image = tolerance_stage_make_image(&job);
    int missed = 0;

    (void)state;
    for (int i = 0; i < FRAMES; i++) {
        struct tolerance_params params = {
            .job = &job, .serial = i + 1, .image = &image, .repeated = &quality, .repeated_number = 1};
        struct tolerance_result result;
        struct error error = {{0}};

        snprintf(job.hash, sizeof job.hash, "job %d", i);
        if (!tolerance_render(stage.tolerance, &params, &result, &error)) fail_msg("%s", error.message);
        missed += result.audit.is_missed;
    }
    print_message("%d of %d frames are known to be over the tolerance\n", missed, FRAMES);
    assert_int_equal(missed, FRAMES);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lost_light_is_noticed),
        cmocka_unit_test(a_frame_that_loses_light_is_no_good_one),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
