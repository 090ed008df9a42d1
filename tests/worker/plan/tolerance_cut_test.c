// Frames with a tolerance whose loops GL cuts in some pixel that no pilot has: the next rendering has shorter ones.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tolerance_stage.h"
#include "worker/picture/image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

// A glow of noise with a box in it, which bars light grids and slices.
static struct job glow_job(void)
{
    static const char text[] =
        "{\"version\":1,\"name\":\"glow\",\"frames\":\"0\",\"fps\":24,\"resolution\":[160,90],\"camera\":{\"position\":"
        "[0,0,4],\"target\":[0,0,0],\"fov\":40},\"lights\":[{\"kind\":\"point\",\"intensity\":5,\"position\":[2,2,2]}],"
        "\"scene\":{\"media\":[{\"sigma_s\":16,\"density\":{\"kind\":\"noise\",\"frequency\":4,\"octaves\":3,"
        "\"bounds\":"
        "{\"kind\":\"sphere\",\"radius\":1,\"falloff\":0.3}}}],\"objects\":[{\"kind\":\"box\",\"center\":[0,-0.5,0],"
        "\"size\":[0.5,0.5,0.5],\"material\":{\"kind\":\"diffuse\",\"albedo\":0.5}}]},"
        "\"output\":{\"path\":\"glow.####.exr\"},\"quality\":{\"tolerance\":0.02}}";
    struct error error = {{0}};
    struct job job;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    return job;
}

// Cuts the last pixel of a whole picture, which lists of pixels are too small for, as GL cuts loops that are too long.
static void cut_short_steps(const char *folder, double light_step)
{
    char path[4096];
    FILE *out;

    mkdir(folder, 0700);
    snprintf(path, sizeof path, "%s/path", folder);
    mkdir(path, 0700);
    snprintf(path, sizeof path, "%s/path/iterations.glsl", folder);
    out = fopen(path, "w");
    assert_non_null(out);
    fprintf(out,
            "bool path_iterations_are_spent()\n{\n"
            "    return quality_light_step < %.9f && gl_FragCoord.x > 159.0 && gl_FragCoord.y > 89.0;\n}\n",
            light_step);
    fclose(out);
}

static double planned_light_step(const struct job *job)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct tolerance_result result;
    struct error error = {{0}};
    struct image image;

    if (!tolerance_stage_render(stage, job, 0, &image, &result, &error)) fail_msg("%s", error.message);
    print_message("light_step %.3g: %s\n", result.quality.light_step, result.reason);
    assert_int_equal(result.retry_count, 0);
    image_finish(&image);
    tolerance_stage_close(stage);
    return result.quality.light_step;
}

static void loops_that_are_cut_become_shorter(void **state)
{
    struct job job = glow_job();
    double light_step = planned_light_step(&job);
    struct tolerance_result result;
    struct error error = {{0}};
    struct tolerance_stage stage;
    struct image image;

    cut_short_steps(temp_folder_path(state, "shaders"), 1.2 * light_step);
    stage = tolerance_stage_open(temp_folder_path(state, "shaders"));
    if (!tolerance_stage_render(stage, &job, 0, &image, &result, &error)) fail_msg("%s", error.message);
    print_message("%.3g instead of %.3g: %s\n", result.quality.light_step, light_step, result.reason);
    assert_int_equal(result.retry_count, 1);
    assert_true(result.quality.light_step >= 1.2 * light_step && result.quality.light_step < 1.5 * light_step);
    assert_true(result.audit.error <= 0.02 && result.audit.ray_count > 0);
    assert_non_null(strstr(result.reason, "GL cut the loops of"));
    image_finish(&image);
    // It made the segment's next plan.
    if (!tolerance_stage_render(stage, &job, 0, &image, &result, &error)) fail_msg("%s", error.message);
    assert_int_equal(result.retry_count, 0);
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

static void loops_that_stay_too_long_are_told(void **state)
{
    const char *folder = temp_folder_path(state, "shaders");
    struct job job = glow_job();
    struct tolerance_result result;
    struct error error = {{0}};
    struct tolerance_stage stage;
    struct image image;

    cut_short_steps(folder, 1e6);
    stage = tolerance_stage_open(folder);
    assert_false(tolerance_stage_render(stage, &job, 0, &image, &result, &error));
    print_message("%s\n", error.message);
    assert_int_equal(result.render.fault, RENDERER_FAULT_ENDLESS);
    assert_true(result.retry_count > 1);
    assert_non_null(strstr(error.message, "needs more iterations of its loops than "));
    assert_non_null(strstr(error.message, "expected a larger tolerance, or a GPU"));
    image_finish(&image);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(loops_that_are_cut_become_shorter, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(loops_that_stay_too_long_are_told, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
