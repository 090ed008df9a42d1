// Frames that no setting keeps within their tolerance, for the shader is broken: given up, or published on request.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tolerance_stage.h"
#include "worker/glsl/shader_sources.h"
#include "worker/picture/image.h"
#include "worker/plan/tolerance.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

enum { FRAME = 3 };

// Fog that scatters forwards: its finest setting takes little.
static struct job fog_job(void)
{
    static const char text[] =
        "{\"version\":1,\"name\":\"fog\",\"frames\":\"0-9\",\"fps\":24,\"resolution\":[32,18],\"camera\":{\"position\":"
        "[0,0,4],\"target\":[0,0,0],\"fov\":40},\"lights\":[{\"kind\":\"point\",\"intensity\":3,\"position\":[2,1,2]}],"
        "\"scene\":{\"media\":[{\"sigma_s\":1,\"phase\":[{\"g\":0.6}],\"density\":{\"kind\":\"homogeneous\",\"bounds\":"
        "{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}}}]},"
        "\"output\":{\"path\":\"fog.####.exr\"},\"quality\":{\"tolerance\":0.2}}";
    struct error error = {{0}};
    struct job job;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    return job;
}

// The coarsest setting first: the search for one that keeps the tolerance would end at the finest.
static bool render(struct tolerance_stage stage, const struct job *job, struct image *image,
                   struct tolerance_result *result, struct error *error)
{
    *image = tolerance_stage_make_image(job);
    return tolerance_render(
        stage.tolerance,
        &(struct tolerance_params){
            .job = job, .serial = 1, .frame = FRAME, .image = image, .choice = PLAN_CHOICE_COARSEST},
        result, error);
}

// A broken shader: its phase function scatters backwards what should go forwards.
static void break_phase(const char *folder)
{
    char path[4096], *text;

    snprintf(path, sizeof path, "%s/phase", folder);
    mkdir(folder, 0700);
    mkdir(path, 0700);
    text = shader_sources_load(NULL, "phase/henyey_greenstein.glsl", NULL);
    assert_non_null(text);
    snprintf(path, sizeof path, "%s/phase/henyey_greenstein.glsl", folder);
    {
        FILE *out = fopen(path, "w");
        char *place = strstr(text, "incoming - sign");

        assert_non_null(out);
        assert_non_null(place);
        place[strlen("incoming ")] = '+';
        fputs(text, out);
        fclose(out);
    }
    free(text);
}

static void a_broken_frame_is_rendered_again_and_given_up(void **state)
{
    const char *folder = temp_folder_path(state, "shaders");
    struct job job = fog_job();
    struct tolerance_result result;
    struct error error = {{0}};
    struct tolerance_stage stage;
    struct image image;

    break_phase(folder);
    stage = tolerance_stage_open(folder);
    assert_false(render(stage, &job, &image, &result, &error));
    print_message("%s\n", error.message);
    assert_int_equal(result.render.fault, RENDERER_FAULT_MISSED);
    assert_true(result.retry_count > 0 && result.audit.error > 0.2);
    assert_non_null(strstr(error.message, "quality.tolerance: expected an error of at most 0.2, got "));
    assert_non_null(strstr(error.message, " at best, by "));
    assert_non_null(strstr(error.message, "expected a larger tolerance, a method with finer numbers, or \"on_miss\""));
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static bool is_same(const struct image *a, const struct image *b)
{
    return memcmp(a->rgba, b->rgba, 16 * (size_t)a->width_px * (size_t)a->height_px) == 0;
}

// Renders the frame by that quality.
static struct image render_by(struct tolerance_stage stage, struct job job, const struct job_quality *quality)
{
    struct image image = tolerance_stage_make_image(&job);
    struct renderer_result result;

    job.quality = *quality;
    assert_true(renderer_render(stage.gl.renderer,
                                &(struct renderer_frame){.job = &job, .frame = FRAME, .image = &image}, &result, NULL));
    return image;
}

// The picture and the numbers are those of the rendering with the least error, each time the same.
static void a_broken_frame_is_published_where_the_job_asks_for_it(void **state)
{
    const char *folder = temp_folder_path(state, "shaders");
    struct job job = fog_job();
    struct image images[2];

    break_phase(folder);
    job.quality.on_miss = JOB_ON_MISS_PUBLISH;
    for (int i = 0; i < 2; i++) {
        struct tolerance_stage stage = tolerance_stage_open(folder);
        struct tolerance_result result;
        struct error error = {{0}};
        struct image again;

        if (!render(stage, &job, &images[i], &result, &error)) fail_msg("%s", error.message);
        assert_true(result.audit.is_missed && result.retry_count > 0);
        assert_true(result.audit.error > 0.2 && result.audit.error <= result.first_error);
        assert_true(isfinite(result.audit.error95) && strlen(result.render.shader_hash) == 32);
        again = render_by(stage, job, &result.quality);
        assert_true(is_same(&images[i], &again));
        image_finish(&again);
        tolerance_stage_close(stage);
    }
    assert_true(is_same(&images[0], &images[1]));
    image_finish(&images[0]);
    image_finish(&images[1]);
    job_finish(&job);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_broken_frame_is_rendered_again_and_given_up, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_broken_frame_is_published_where_the_job_asks_for_it, temp_folder_create,
                                        temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
