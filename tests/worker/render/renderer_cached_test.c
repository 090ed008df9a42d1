// Light grids are filled when needed and kept otherwise, and pictures do not depend on it.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/shader/light_grid_glue.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define STILL "[0.8, 1, -0.9]"
#define MOVING "{ \"start\": [0.8, 1, -0.9], \"rate\": [-12, 0, 6] }"

static void parse(struct job *job, const char *camera, const char *light, const char *sigma_s, const char *more)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"grids\", \"frames\": \"0-9\", \"fps\": 24, \"resolution\": [24, 16],"
             " \"camera\": { \"position\": %s, \"target\": [0, 0, 0], \"fov\": 40, \"shutter\": 1 },"
             " \"lights\": [ { \"kind\": \"point\", \"intensity\": 3, \"position\": %s },"
             " { \"kind\": \"sun\", \"intensity\": 1, \"direction\": [1, -2, 0.5] } ], \"scene\": { \"media\": ["
             " { \"density\": { \"kind\": \"fold_fractal\", \"iterations\": 3, \"offset\": 0.05, \"radius\": 0.3,"
             " \"rotate_x_rad\": 0.3, \"rotate_y_rad\": 0.7, \"exponent\": 1.3, \"scale\": 10 }, \"sigma_s\": %s } ] },"
             " \"quality\": { \"method\": \"cached\", \"step\": 0.02, \"light_grid\": 24%s },"
             " \"output\": { \"path\": \"grids.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             camera, light, sigma_s, more);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static struct image render(struct gl_stage stage, const struct job *job, int32_t frame, int64_t *fills)
{
    struct error error = {{0}};
    struct renderer_result result;
    struct image image;

    assert_true(
        image_init(&image, job->width_px, job->height_px, job->output.has_transmittance, job->output.has_depth, NULL));
    if (!renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = &image}, &result,
                         &error))
        fail_msg("%s", error.message);
    if (fills) *fills = result.cache_fills;
    return image;
}

static int64_t count_fills(struct gl_stage stage, const struct job *job, int32_t frame)
{
    int64_t fills;
    struct image image = render(stage, job, frame, &fills);

    image_finish(&image);
    return fills;
}

static void grids_stay_while_the_camera_moves(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct job job;

    (void)state;
    parse(&job, "{ \"start\": [0, 0, -2], \"rate\": [3, 0, 0] }", STILL, "{ \"start\": 6, \"rate\": 1 }", "");
    assert_int_equal(count_fills(stage, &job, 0), 2 * LIGHT_GRID_CACHES);
    for (int32_t frame = 1; frame < 4; frame++)
        assert_int_equal(count_fills(stage, &job, frame), 0);
    job_finish(&job);
    gl_stage_close(stage);
}

static void only_the_light_that_moves_has_a_new_grid(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct job job;

    (void)state;
    parse(&job, "[0, 0, -2]", MOVING, "6", "");
    assert_int_equal(count_fills(stage, &job, 0), 2 * LIGHT_GRID_CACHES);
    assert_int_equal(count_fills(stage, &job, 1), LIGHT_GRID_CACHES);
    assert_int_equal(count_fills(stage, &job, 0), 0); // the first grid is still kept
    job.quality.light_grid = 30;
    assert_int_equal(count_fills(stage, &job, 0), 2 * LIGHT_GRID_CACHES);
    job_finish(&job);
    gl_stage_close(stage);
}

// A picture with the uniforms of the frame before is rendered when its grids differ.
static void another_density_is_another_picture(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct image first, second;
    struct job job;

    (void)state;
    parse(&job, "[0, 0, -2]", STILL, "6", "");
    first = render(stage, &job, 0, NULL);
    job.scene.media[0].density.fold_fractal.scale.value[0] = 9;
    second = render(stage, &job, 0, NULL);
    assert_true(memcmp(first.rgba, second.rgba, (size_t)first.width_px * (size_t)first.height_px * 16) != 0);
    image_finish(&first);
    image_finish(&second);
    job_finish(&job);
    gl_stage_close(stage);
}

static void each_moment_of_the_shutter_has_grids_of_its_own(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct job job;

    (void)state;
    parse(&job, "[0, 0, -2]", MOVING, "6", ", \"samples\": 4");
    assert_int_equal(count_fills(stage, &job, 0), 5 * LIGHT_GRID_CACHES);
    job_finish(&job);
    gl_stage_close(stage);
}

static double difference(const struct image *a, const struct image *b)
{
    size_t count = 4 * (size_t)a->width_px * (size_t)a->height_px;
    double square = 0, sum = 0;

    for (size_t i = 0; i < count; i++) {
        square += pow(a->rgba[i] - b->rgba[i], 2);
        sum += pow(b->rgba[i], 2);
    }
    return sqrt(square / sum);
}

// A frame does not depend on the frames rendered before it or on the grids that were kept.
static void frames_do_not_depend_on_what_is_kept(void **state)
{
    struct gl_stage used = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir()),
                    fresh = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct image first, second;
    struct job job;

    (void)state;
    parse(&job, "[0, 0, -2]", MOVING, "6", ", \"samples\": 2");
    for (int32_t frame = 3; frame > 0; frame--)
        count_fills(used, &job, frame);
    first = render(used, &job, 2, NULL);
    second = render(fresh, &job, 2, NULL);
    assert_memory_equal(first.rgba, second.rgba, (size_t)first.width_px * (size_t)first.height_px * 16);
    image_finish(&first);
    image_finish(&second);
    job_finish(&job);
    gl_stage_close(used);
    gl_stage_close(fresh);
}

static void backends_agree(void **state)
{
    struct gl_stage software = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir()), egl;
    struct image first, second;
    struct job job;

    (void)state;
    parse(&job, "[0, 0, -2]", "[0.15, -0.05, 0.1]", "6", "");
    first = render(software, &job, 0, NULL);
    gl_stage_close(software);
    egl = gl_stage_open(GL_BACKEND_EGL, test_shader_dir());
    second = render(egl, &job, 0, NULL);
    assert_true(difference(&first, &second) <= 1e-4);
    image_finish(&first);
    image_finish(&second);
    job_finish(&job);
    gl_stage_close(egl);
}

static bool stop_at_once(void *user, double done)
{
    (void)done;
    ++*(int *)user;
    return false;
}

static void a_grid_that_is_made_can_be_stopped(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct image image;
    struct job job;
    int calls = 0;

    (void)state;
    parse(&job, "[0, 0, -2]", STILL, "6", "");
    assert_true(image_init(&image, job.width_px, job.height_px, true, true, NULL));
    assert_false(renderer_render(
        stage.renderer,
        &(struct renderer_frame){.job = &job, .frame = 0, .image = &image, .on_progress = stop_at_once, .user = &calls},
        &result, NULL));
    assert_int_equal(result.fault, RENDERER_FAULT_STOPPED);
    assert_int_equal(calls, 1);
    assert_int_equal(result.cache_fills, 0);
    image_finish(&image);
    assert_int_equal(count_fills(stage, &job, 0), 2 * LIGHT_GRID_CACHES);
    job_finish(&job);
    gl_stage_close(stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grids_stay_while_the_camera_moves),
        cmocka_unit_test(only_the_light_that_moves_has_a_new_grid),
        cmocka_unit_test(another_density_is_another_picture),
        cmocka_unit_test(each_moment_of_the_shutter_has_grids_of_its_own),
        cmocka_unit_test(frames_do_not_depend_on_what_is_kept),
        cmocka_unit_test(backends_agree),
        cmocka_unit_test(a_grid_that_is_made_can_be_stopped),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
