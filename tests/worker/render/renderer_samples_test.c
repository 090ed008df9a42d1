// Frames of several samples a pixel and of an open shutter.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/scene/pixel_samples.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define MOVING_LIGHT                                                                                                   \
    "\"lights\": [{\"kind\": \"point\", \"intensity\": 3, \"position\": {\"start\": [2, 1, 2], \"rate\": [-60, 10, "   \
    "0]}}]"
#define STILL_BALL "\"sigma_s\": 1, \"sigma_a\": 0.5"

static struct image make_image(const struct job *job)
{
    struct image image;

    assert_true(image_init(&image, job->width_px, job->height_px, true, true, NULL));
    return image;
}

static struct image render(struct gl_stage stage, const struct job *job, int32_t frame, bool *is_copy)
{
    struct image image = make_image(job);
    struct renderer_result result;
    struct error error = {{0}};

    if (!renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = &image}, &result,
                         &error))
        fail_msg("%s", error.message);
    if (is_copy) *is_copy = result.is_copy;
    return image;
}

// Renders with a new context and a new renderer, as a worker that has just started.
static struct image render_afresh(const struct job *job, int32_t frame)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct image image = render(stage, job, frame, NULL);

    gl_stage_close(stage);
    return image;
}

static void assert_images_equal(const struct image *a, const struct image *b)
{
    size_t count = (size_t)a->width_px * (size_t)a->height_px;

    assert_memory_equal(a->rgba, b->rgba, 16 * count);
    assert_memory_equal(a->transmittance, b->transmittance, 16 * count);
    assert_memory_equal(a->depth, b->depth, 4 * count);
}

static struct job ball(const char *medium, const char *rest, int samples, double shutter)
{
    struct job job;

    ball_job_parse(&job, medium, rest);
    job.quality.samples = samples;
    job.scene.camera.shutter = shutter;
    return job;
}

static void a_frame_is_the_same_in_any_order_and_after_a_restart(void **state)
{
    struct job job = ball(STILL_BALL, MOVING_LIGHT ", " BALL_JOB_MIDPOINT, 3, 0.5);
    struct image alone[3], in_order[3];
    struct gl_stage stage;

    example_job_shrink(&job, 40, 150, 0);
    for (int frame = 0; frame < 3; ++frame)
        alone[frame] = render_afresh(&job, frame);
    stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    for (int frame = 0; frame < 3; ++frame) { // tiles grow from frame to frame
        in_order[frame] = render(stage, &job, frame, NULL);
        assert_images_equal(&in_order[frame], &alone[frame]);
        image_finish(&in_order[frame]);
        image_finish(&alone[frame]);
    }
    gl_stage_close(stage);
    job_finish(&job);
}

static void a_constant_job_renders_its_samples_once(void **state)
{
    struct job job = ball(STILL_BALL, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT, 4, 1);
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct image first, second;
    bool is_copy;

    first = render(stage, &job, 0, &is_copy);
    assert_false(is_copy);
    second = render(stage, &job, 7, &is_copy);
    assert_true(is_copy);
    assert_images_equal(&first, &second);
    image_finish(&second);
    second = render_afresh(&job, 7);
    assert_images_equal(&first, &second);
    image_finish(&first);
    image_finish(&second);
    gl_stage_close(stage);
    job_finish(&job);
}

struct watch {
    double last;
    int calls, stop_at; // 0: never
};

static bool watch_progress(void *user, double done)
{
    struct watch *watch = user;

    assert_true(done > watch->last && done <= 1);
    watch->last = done;
    return ++watch->calls != watch->stop_at;
}

static void progress_counts_all_passes(void **state)
{
    struct job job = ball(STILL_BALL, MOVING_LIGHT ", " BALL_JOB_MIDPOINT, 4, 1);
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct image image = make_image(&job);
    struct renderer_result result;
    struct watch all = {0}, some = {.stop_at = 2};

    assert_false(
        renderer_render(stage.renderer,
                        &(struct renderer_frame){
                            .job = &job, .frame = 0, .image = &image, .on_progress = watch_progress, .user = &some},
                        &result, NULL));
    assert_int_equal(result.fault, RENDERER_FAULT_STOPPED);
    assert_true(some.last <= 0.5);
    assert_true(renderer_render(
        stage.renderer,
        &(struct renderer_frame){.job = &job, .frame = 0, .image = &image, .on_progress = watch_progress, .user = &all},
        &result, NULL));
    assert_false(result.is_copy);
    assert_true(all.calls >= 4);
    assert_near(all.last, 1, 0);
    image_finish(&image);
    gl_stage_close(stage);
    job_finish(&job);
}

static void passes_that_show_the_same_are_drawn_once(void **state)
{
    // Without a visible medium all points of a pixel are equal.
    struct job job =
        ball("\"sigma_s\": 0, \"sigma_a\": 0", "\"background\": [0.1, 0.2, 0.3], " BALL_JOB_MIDPOINT, 64, 1);
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct image image = make_image(&job);
    struct renderer_result result;
    struct watch watch = {0};

    assert_true(
        renderer_render(stage.renderer,
                        &(struct renderer_frame){
                            .job = &job, .frame = 0, .image = &image, .on_progress = watch_progress, .user = &watch},
                        &result, NULL));
    assert_int_equal(watch.calls, 1);
    assert_true(image.rgba[0] == 0.1f && image.rgba[1] == 0.2f && image.rgba[2] == 0.3f && image.rgba[3] == 1.0f);
    image_finish(&image);
    gl_stage_close(stage);
    job_finish(&job);
}

static void a_background_that_moves_is_averaged_over_the_shutter(void **state)
{
    struct job job = ball("\"sigma_s\": 0, \"sigma_a\": 0",
                          "\"background\": {\"start\": [1, 1, 1], \"rate\": [24, 48, 0]}, " BALL_JOB_MIDPOINT, 8, 0.5);
    struct image image = render_afresh(&job, 2);

    // The mean of a linear function is its value in the middle, exact except for the rounding of a sum of eight.
    assert_near(image.rgba[0], 3.25, 1e-6);
    assert_near(image.rgba[1], 5.5, 1e-6);
    assert_near(image.rgba[2], 1, 0);
    image_finish(&image);
    job_finish(&job);
}

static void one_sample_sees_the_middle_of_the_shutter(void **state)
{
    struct job open = ball(STILL_BALL, MOVING_LIGHT ", " BALL_JOB_MIDPOINT, 1, 1), still;
    struct image of_open = render_afresh(&open, 3), of_still;

    still = ball(STILL_BALL, MOVING_LIGHT ", " BALL_JOB_MIDPOINT, 1, 0);
    still.time_offset = 0.5 / 24;
    of_still = render_afresh(&still, 3);
    assert_images_equal(&of_open, &of_still);
    image_finish(&of_open);
    image_finish(&of_still);
    job_finish(&open);
    job_finish(&still);
}

// Finds the mean light along the rays of the job's samples with the reference.
static struct reference_pixel measure_mean(const struct job *job, int32_t frame, int x, int y)
{
    struct reference_sample samples[8];
    size_t count = (size_t)job->quality.samples;

    assert_true(count <= sizeof samples / sizeof *samples);
    for (size_t k = 0; k < count; ++k) {
        struct pixel_point point = pixel_samples_point(job, frame, x, y, (int)k);

        samples[k] = (struct reference_sample){(double)point.x_px - x, (double)point.y_px - y,
                                               pixel_samples_time(job, frame, (int)k), k};
    }
    return reference_measure_samples(job, NULL, x, y, samples, count, NULL);
}

static void assert_is_mean_of_reference(const struct job *job)
{
    enum { WIDTH_PX = 24, HEIGHT_PX = 16, PIXELS = WIDTH_PX * HEIGHT_PX };
    static float values[4 * PIXELS];
    static double wanted[4 * PIXELS];
    struct image image = render_afresh(job, 3);
    struct reference_error error;

    assert_true(job->width_px == WIDTH_PX && job->height_px == HEIGHT_PX);
    for (int i = 0; i < PIXELS; ++i) {
        struct reference_pixel pixel = measure_mean(job, 3, i % WIDTH_PX, i / WIDTH_PX);

        memcpy(&wanted[4 * i], pixel.radiance, sizeof pixel.radiance);
        wanted[4 * i + 3] = pixel.alpha;
        memcpy(&values[4 * i], &image.rgba[4 * i], sizeof(float[4]));
    }
    error = reference_image_error(values, wanted, 4 * PIXELS);
    print_message("relative RMSE %.2e, largest error %.2e\n", error.relative_rmse, error.largest);
    // Midpoint steps have second order and are a thirtieth of the scene. Other points or times differ a hundred times
    // more.
    assert_true(error.relative_rmse <= 5e-4);
    image_finish(&image);
}

static void a_moving_light_is_the_mean_along_the_same_rays(void **state)
{
    struct job job = ball(STILL_BALL, MOVING_LIGHT ", " BALL_JOB_MIDPOINT, 5, 1);

    example_job_shrink(&job, 24, 16, 0);
    job.quality.step = job.quality.light_step = 0.02;
    assert_is_mean_of_reference(&job);
    job_finish(&job);
}

static void a_moving_fractal_and_camera_are_the_mean_along_the_same_rays(void **state)
{
    struct job job;

    example_job_load(&job, "cloud");
    example_job_shrink(&job, 24, 16, 2);
    job.quality.samples = 3;
    job.scene.camera.shutter = 24;
    job.scene.camera.position =
        (struct timeline){.kind = TIMELINE_LINEAR, .component_count = 3, .linear = {{0, 0, -2}, {0.1, 0, 0}}};
    job.scene.camera.clip_near = 0;
    job.scene.camera.clip_far = INFINITY;
    job.quality.step = 0.002;
    job.quality.light_step = 0.01;
    assert_is_mean_of_reference(&job);
    job_finish(&job);
}

// Finds the share of the pixel that the opaque unit ball covers, by points on a fine grid.
static double measure_coverage(const struct still *still, int x, int y)
{
    enum { SIDE = 64 };
    int inside = 0;

    for (int i = 0; i < SIDE * SIDE; ++i) {
        struct ray ray =
            camera_pinhole_ray(&still->camera, x + (i % SIDE + 0.5) / SIDE, y + (i / SIDE + 0.5) / (double)SIDE);
        double along = -vec3_dot(ray.origin, ray.direction);

        inside += vec3_dot(ray.origin, ray.origin) - along * along < 1;
    }
    return inside / (double)(SIDE * SIDE);
}

// Finds the mean square error of alpha in the pixels at the ball's edge.
static double measure_edge(int samples, int *pixels)
{
    struct job job = ball("\"sigma_s\": 0, \"sigma_a\": 1e5", BALL_JOB_MIDPOINT, samples, 0);
    struct image image = render_afresh(&job, 0);
    double squares = 0, sum = 0;
    struct still still;

    still_init(&still, &job, 0);
    *pixels = 0;
    for (int i = 0; i < job.width_px * job.height_px; ++i) {
        double coverage = measure_coverage(&still, i % job.width_px, i / job.width_px);
        double error = (double)image.rgba[4 * i + 3] - coverage;

        if (coverage == 0 || coverage == 1) {
            assert_true(samples > 1 || coverage == 0 || fabs(error) < 1e-6);
            continue;
        }
        squares += error * error;
        sum += error;
        ++*pixels;
        // The edge crosses at most three of four strata; the others are inside or outside.
        if (samples == 4) assert_true(fabs(error) <= 3.0 / 4 + 1e-3);
    }
    // The estimate is unbiased: the sum of independent errors with deviations of at most 1/2 is within four deviations.
    if (samples > 1) assert_true(fabs(sum) <= 4 * 0.5 / sqrt(samples) * sqrt(*pixels));
    image_finish(&image);
    job_finish(&job);
    return squares / *pixels;
}

static void an_edge_gets_the_share_of_its_pixel(void **state)
{
    int pixels;
    double four = measure_edge(4, &pixels), sixteen = measure_edge(16, &pixels), many = measure_edge(64, &pixels);

    print_message("mean square errors %.2e, %.2e, %.2e over %d pixels\n", four, sixteen, many, pixels);
    // An edge crosses about 1.3 sqrt(n) of n strata, each with a variance of at most 1/4 / n^2: half of that is
    // typical. Points that are not stratified have 1/6 / n.
    assert_true(four <= 0.75 * 1.3 * 2 / 4 / 16);
    // The error falls as n^(-3/2): sixteen times the samples make it 64 times smaller. Independent points make it 16
    // times smaller.
    assert_true(many <= four / 32);
    assert_true(sixteen <= four / 5);
}

static void depth_is_the_mean_of_those_that_have_one(void **state)
{
    struct job one = ball("\"sigma_s\": 0, \"sigma_a\": 1e5", BALL_JOB_MIDPOINT, 1, 0);
    struct job many = ball("\"sigma_s\": 0, \"sigma_a\": 1e5", BALL_JOB_MIDPOINT, 16, 0);
    struct image of_one = render_afresh(&one, 0), of_many = render_afresh(&many, 0);

    for (int i = 0; i < one.width_px * one.height_px; ++i) {
        double alpha = (double)of_many.rgba[4 * i + 3];

        assert_true((of_many.depth[i] > 0) == (alpha > 0));
        // Depth is that of the visible half of the ball, whatever its share of the pixel.
        if (alpha > 0) assert_true(of_many.depth[i] > 2.99f && of_many.depth[i] < 4.0f);
        if (alpha == 1) assert_near(of_many.depth[i], of_one.depth[i], 0.1);
    }
    image_finish(&of_one);
    image_finish(&of_many);
    job_finish(&one);
    job_finish(&many);
}

static void a_march_that_is_cut_in_one_pass_is_an_error(void **state)
{
    // The ball shrinks to nothing: only the first pass has a medium to march through.
    struct job job = ball(BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT, 4, 1);
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct error error = {{0}};
    struct image image;

    job.scene.media[0].density.fold_fractal.radius =
        (struct timeline){.kind = TIMELINE_LINEAR, .component_count = 1, .linear = {{1}, {-24 * 1.2}}};
    job.width_px = job.height_px = 4;
    job.quality.light_step = 1e-6;
    image = make_image(&job);
    assert_false(renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image},
                                 &result, &error));
    assert_int_equal(result.fault, RENDERER_FAULT_ENDLESS);
    assert_non_null(strstr(error.message, "quality: pixel"));
    image_finish(&image);
    gl_stage_close(stage);
    job_finish(&job);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_is_the_same_in_any_order_and_after_a_restart),
        cmocka_unit_test(a_constant_job_renders_its_samples_once),
        cmocka_unit_test(progress_counts_all_passes),
        cmocka_unit_test(passes_that_show_the_same_are_drawn_once),
        cmocka_unit_test(a_background_that_moves_is_averaged_over_the_shutter),
        cmocka_unit_test(one_sample_sees_the_middle_of_the_shutter),
        cmocka_unit_test(a_moving_light_is_the_mean_along_the_same_rays),
        cmocka_unit_test(a_moving_fractal_and_camera_are_the_mean_along_the_same_rays),
        cmocka_unit_test(an_edge_gets_the_share_of_its_pixel),
        cmocka_unit_test(depth_is_the_mean_of_those_that_have_one),
        cmocka_unit_test(a_march_that_is_cut_in_one_pass_is_an_error),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
