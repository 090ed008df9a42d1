// SPDX-License-Identifier: Apache-2.0
#include "worker/render/renderer.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/temp_folder.h"
#include "worker/gl/gl_program.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

static struct image make_image(const struct job *job)
{
    struct image image;

    assert_true(
        image_init(&image, job->width_px, job->height_px, job->output.has_depth, job->output.has_transmittance, NULL));
    return image;
}

static struct image render(struct gl_stage stage, const struct job *job, int32_t frame, struct renderer_result *result)
{
    struct image image = make_image(job);
    struct error error = {{0}};

    if (!renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = &image}, result,
                         &error))
        fail_msg("%s", error.message);
    assert_int_equal(result->fault, RENDERER_FAULT_NONE);
    return image;
}

// Renders one frame of a ball with a new renderer.
static struct image render_ball(const char *medium, const char *rest, struct renderer_result *result)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    struct job job;
    struct image image;

    ball_job_parse(&job, medium, rest);
    image = render(stage, &job, 0, result);
    job_finish(&job);
    gl_stage_close(stage);
    return image;
}

static const float *pixel(const struct image *image, int x, int y)
{
    return &image->rgba[4 * (y * image->width_px + x)];
}

static void assert_images_equal(const struct image *a, const struct image *b)
{
    assert_memory_equal(a->rgba, b->rgba, 16 * (size_t)(a->width_px * a->height_px));
}

static double largest_difference(const struct image *a, const struct image *b)
{
    double largest = 0;

    for (int i = 0; i < 4 * a->width_px * a->height_px; ++i)
        largest = fmax(largest, fabs((double)a->rgba[i] - b->rgba[i]));
    return largest;
}

static void a_constant_job_renders_once_and_copies(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    struct renderer_result result;
    struct image first, second, other;
    struct job job, moving;

    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    example_job_load(&moving, "cloud");
    example_job_shrink(&moving, 48, 32, 0);
    first = render(stage, &job, 0, &result);
    assert_false(result.is_copy);
    second = render(stage, &job, 5, &result);
    assert_true(result.is_copy);
    assert_images_equal(&first, &second);
    other = render(stage, &moving, 0, &result);
    assert_false(result.is_copy);
    image_finish(&other);
    other = render(stage, &moving, 1, &result);
    assert_false(result.is_copy);
    image_finish(&second);
    second = render(stage, &job, 6, &result);
    assert_false(result.is_copy);
    assert_images_equal(&first, &second);
    image_finish(&first);
    image_finish(&second);
    image_finish(&other);
    job_finish(&job);
    job_finish(&moving);
    gl_stage_close(stage);
}

static bool count_tile(void *user, double done)
{
    assert_true(done > 0 && done <= 1);
    ++*(int *)user;
    return true;
}

static void tiles_do_not_change_pixels(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    struct renderer_result result;
    struct image images[2];
    int tiles[2] = {0, 0};
    struct job job;

    // The frame is so cheap that tiles grow on a busy machine too.
    ball_job_parse(&job, BALL_JOB_SIGMA_S_1,
                   "\"lights\": [{\"kind\": \"point\", \"intensity\": 3, \"position\": {\"start\": [2, 1, 2], \"rate\":"
                   " [1, 0, 0]}}], " BALL_JOB_MIDPOINT);
    example_job_shrink(&job, 40, 150, 0);
    for (int i = 0; i < 2; ++i) {
        struct image between;

        images[i] = make_image(&job);
        assert_true(renderer_render(
            stage.renderer,
            &(struct renderer_frame){
                .job = &job, .frame = 0, .image = &images[i], .on_progress = count_tile, .user = &tiles[i]},
            &result, NULL));
        between = render(stage, &job, 1, &result); // the picture changes, and tiles grow
        image_finish(&between);
    }
    assert_true(tiles[0] > tiles[1]);
    assert_images_equal(&images[0], &images[1]);
    image_finish(&images[0]);
    image_finish(&images[1]);
    job_finish(&job);
    gl_stage_close(stage);
}

static void note_link(void *user, bool begins)
{
    int *links = user;

    assert_int_equal(begins, links[0] == links[1]);
    links[begins ? 0 : 1]++;
}

static void linking_is_told_where_a_program_is_new(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    struct renderer_result result;
    int links[2] = {0}; // begun, ended
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    renderer_watch_links(stage.renderer, note_link, links);
    for (int frame = 0; frame < 2; frame++) {
        struct image image = render(stage, &job, frame, &result);

        assert_int_equal(links[0], 1);
        assert_int_equal(links[1], 1);
        image_finish(&image);
    }
    job_finish(&job);
    gl_stage_close(stage);
}

static bool refuse(void *user, double done)
{
    return false;
}

static void a_stopped_frame_is_rendered_anew(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    struct renderer_result result;
    struct image image;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    image = make_image(&job);
    assert_false(renderer_render(
        stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image, .on_progress = refuse},
        &result, NULL));
    assert_int_equal(result.fault, RENDERER_FAULT_STOPPED);
    assert_true(renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image},
                                &result, NULL));
    assert_false(result.is_copy);
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
}

static void grey_and_rgb_give_equal_pictures_of_a_grey_scene(void **state)
{
    static const char *const qualities[] = {BALL_JOB_MIDPOINT, BALL_JOB_RIEMANN};

    for (int i = 0; i < 2; ++i) {
        struct renderer_result result;
        char rest[512];
        struct image grey, rgb;

        snprintf(rest, sizeof rest, "%s, %s", BALL_JOB_POINT_LIGHT, qualities[i]);
        grey = render_ball(BALL_JOB_SIGMA_S_1 ", \"emission\": 0.5", rest, &result);
        // The albedo moves, so that it counts as coloured, but is grey in the first frame.
        rgb = render_ball(BALL_JOB_SIGMA_S_1 ", \"emission\": {\"start\": [0.5, 0.5, 0.5], \"rate\": [0, 1, 0]}", rest,
                          &result);
        // Only the order of rounding differs.
        assert_true(largest_difference(&grey, &rgb) < 1e-6);
        for (int k = 0; k < grey.width_px * grey.height_px; ++k)
            assert_true(fabs((double)grey.depth[k] - rgb.depth[k]) < 1e-4);
        image_finish(&grey);
        image_finish(&rgb);
    }
}

// Projects a world point to pixels by the matrix of the file's header.
static void project(const struct renderer_result *result, const struct image *image, const double point[3],
                    double at[2])
{
    const double row[4] = {point[0], point[1], point[2], 1};
    double ndc[4] = {0};

    for (int column = 0; column < 4; ++column)
        for (int k = 0; k < 4; ++k)
            ndc[column] += row[k] * result->world_to_ndc[4 * k + column];
    at[0] = ndc[0] / ndc[3] * image->width_px;
    at[1] = ndc[1] / ndc[3] * image->height_px;
}

static void find_centre(const struct image *image, double at[2])
{
    double sum = 0;

    at[0] = at[1] = 0;
    for (int y = 0; y < image->height_px; ++y)
        for (int x = 0; x < image->width_px; ++x) {
            double alpha = pixel(image, x, y)[3];

            sum += alpha;
            at[0] += alpha * (x + 0.5);
            at[1] += alpha * (y + 0.5);
        }
    assert_true(sum > 1);
    at[0] /= sum;
    at[1] /= sum;
}

static void the_camera_looks_where_its_matrices_say(void **state)
{
    static const double origin[3] = {0};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);

    for (int mirrored = 0; mirrored < 2; ++mirrored) {
        struct renderer_result result;
        struct image image;
        struct job job;
        double seen[2], expected[2];

        ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
        job.width_px = 96;
        job.height_px = 64;
        job.scene.camera.mirror = mirrored;
        // The camera is far to the left of and below the ball, so the ball is right of and above the middle.
        job.scene.camera.position.value[2] = 40;
        job.scene.camera.clip_far = 100;
        job.scene.camera.target.value[0] = -4;
        job.scene.camera.target.value[1] = -3;
        job.scene.camera.fov.value[0] = 20;
        image = render(stage, &job, 0, &result);
        find_centre(&image, seen);
        project(&result, &image, origin, expected);
        // The ball's picture is an ellipse. Its centre is a little farther out than the projection of the ball's
        // centre.
        assert_true(fabs(seen[0] - expected[0]) < 0.1);
        assert_true(fabs(seen[1] - expected[1]) < 0.1);
        assert_true(mirrored ? seen[0] < 40 : seen[0] > 56);
        assert_true(seen[1] < 28);
        // Camera space: right (image), up, forward.
        assert_true(mirrored ? result.world_to_camera[12] < -3 : result.world_to_camera[12] > 3);
        assert_true(result.world_to_camera[13] > 2);
        assert_true(
            fabs(hypot(hypot(result.world_to_camera[12], result.world_to_camera[13]), result.world_to_camera[14]) -
                 40) < 1e-9);
        assert_true(result.world_to_camera[14] > 39);
        image_finish(&image);
        job_finish(&job);
    }
    gl_stage_close(stage);
}

static void an_absorbing_ball_follows_beer_and_lambert(void **state)
{
    struct renderer_result result;
    struct image image = render_ball(BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT, &result);
    double slope = 2 * tan(20 * 3.14159265358979323846 / 180) / image.height_px;

    for (int y = 0; y < image.height_px; ++y)
        for (int x = 0; x < image.width_px; ++x) {
            double u = slope * (x + 0.5 - image.width_px / 2.0), v = slope * (y + 0.5 - image.height_px / 2.0);
            double nearest2 = 16 * (u * u + v * v) / (1 + u * u + v * v);
            double transmittance = nearest2 < 1 ? exp(-2 * sqrt(1 - nearest2)) : 1;
            double depth = transmittance < 0.5
                               ? (4 / sqrt(1 + u * u + v * v) - sqrt(1 - nearest2) + log(2)) / sqrt(1 + u * u + v * v)
                               : 0;
            const float *aov = &image.transmittance[4 * (y * image.width_px + x)];

            // The ball's edges are known to half a step at either side.
            assert_true(fabs(1 - transmittance - pixel(&image, x, y)[3]) < 0.05);
            assert_true(fabs(aov[0] + pixel(&image, x, y)[3] - 1) < 1e-6 && aov[0] == aov[1] && aov[1] == aov[2]);
            if (fabs(transmittance - 0.5) > 0.05) assert_true(fabs(depth - image.depth[y * image.width_px + x]) < 0.05);
        }
    image_finish(&image);
}

static void a_furnace_shows_nothing(void **state)
{
    struct renderer_result result;
    struct image image = render_ball("\"sigma_s\": 0, \"sigma_a\": [1, 20, 0.01], \"emission\": [1, 20, 0.01]",
                                     "\"background\": 1, " BALL_JOB_MIDPOINT, &result);

    // 2e-6: a float's rounding over some fifty segments.
    for (int i = 0; i < image.width_px * image.height_px; ++i)
        for (int channel = 0; channel < 4; ++channel)
            assert_true(fabs((double)image.rgba[4 * i + channel] - 1) < 2e-6);
    image_finish(&image);
}

static void a_light_is_brighter_where_forward_scattering_leads_to_the_eye(void **state)
{
    static const char *const behind =
        "\"lights\": [{\"kind\": \"sun\", \"direction\": [0, 0, 1], \"intensity\": 1}], " BALL_JOB_MIDPOINT;
    static const char *const before =
        "\"lights\": [{\"kind\": \"sun\", \"direction\": [0, 0, -1], \"intensity\": 1}], " BALL_JOB_MIDPOINT;
    static const char *const forward = "\"sigma_s\": 0.01, \"sigma_a\": 0, \"phase\": [{\"g\": 0.8, \"weight\": 1}]";
    struct renderer_result result;
    struct image against = render_ball(forward, behind, &result), along = render_ball(forward, before, &result);
    double ratio = (double)pixel(&against, 24, 16)[0] / pixel(&along, 24, 16)[0];

    // ((1 + g) / (1 - g))^3 = 729 exactly on the axis; the pixel's centre is slightly beside it.
    assert_true(ratio > 700 && ratio < 730);
    image_finish(&against);
    image_finish(&along);
}

static void backends_agree(void **state)
{
    struct renderer_result result;
    struct image images[2];

    for (int i = 0; i < 2; ++i) {
        struct gl_stage stage = gl_stage_open(i == 0 ? GL_BACKEND_EGL : GL_BACKEND_SOFTWARE, NULL);
        struct job job;

        example_job_load(&job, "cloud");
        example_job_shrink(&job, 48, 27, 2);
        images[i] = render(stage, &job, 0, &result);
        job_finish(&job);
        gl_stage_close(stage);
    }
    assert_true(largest_difference(&images[0], &images[1]) < 1e-4);
    image_finish(&images[0]);
    image_finish(&images[1]);
}

static void a_march_that_the_driver_cuts_is_an_error(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    struct error error = {{0}};
    struct renderer_result result;
    struct image image;
    struct job job;

    // The shadow ray needs a million iterations; only camera rays continue in another slice.
    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    job.width_px = job.height_px = 4;
    job.quality.light_step = 1e-6;
    image = make_image(&job);
    assert_false(renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image},
                                 &result, &error));
    assert_int_equal(result.fault, RENDERER_FAULT_ENDLESS);
    assert_non_null(strstr(error.message, "quality: pixel"));
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
}

static void a_broken_module_is_named_with_its_line(void **state)
{
    static const char broken[] =
        "struct RegionSphere { vec3 center; float radius; };\n\nfloat broken = no_such_name;\n";
    struct error error = {{0}};
    struct renderer_result result;
    struct gl_stage stage;
    struct image image;
    struct job job;

    assert_int_equal(mkdir(temp_folder_path(state, "region"), 0700), 0);
    assert_true(file_write_atomic(temp_folder_path(state, "region/sphere.glsl"), broken, sizeof broken - 1, NULL));
    stage = gl_stage_open(GL_BACKEND_AUTO, *state);
    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    image = make_image(&job);
    assert_false(renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image},
                                 &result, &error));
    assert_int_equal(result.fault, RENDERER_FAULT_JOB);
    if (!strstr(error.message, "region/sphere.glsl:3") || !strstr(error.message, "no_such_name"))
        fail_msg("%s", error.message);
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
}

static void a_camera_that_cannot_look_is_an_error(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    struct error error = {{0}};
    struct renderer_result result;
    struct image image;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    image = make_image(&job);
    job.scene.camera.target = job.scene.camera.position;
    assert_false(renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image},
                                 &result, &error));
    assert_non_null(strstr(error.message, "camera.target"));
    job.scene.camera.target.value[2] = 0;
    job.scene.camera.up.value[1] = 0;
    job.scene.camera.up.value[2] = 1; // along the view: the picture may have any rotation
    assert_true(renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image},
                                &result, &error));
    assert_true(image_is_finite(&image, false, NULL));
    assert_true(pixel(&image, 24, 16)[3] > 0.8f);
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
}

static void places_in_every_drivers_log_become_module_names(void **state)
{
    static const char *const names[] = {"generated", "region/sphere.glsl"};
    char *text = gl_program_translate_log(
        "0:10012(5): error: a\n1(10007) : error C0: b\nERROR: 0:3: c\n9:90001: d\nno place\n"
        "0:10001(2): error: `medium_0_own_noise' undeclared, `medium_12_own_x_f', medium_0_owner\n",
        names, 2);

    assert_string_equal(
        text, "region/sphere.glsl:12: error: a\nregion/sphere.glsl:7 : error C0: b\ngenerated:3: c\n9:90001: d\n"
              "no place\nregion/sphere.glsl:1: error: `noise' undeclared, `_f', medium_0_owner\n");
    free(text);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_job_renders_once_and_copies),
        cmocka_unit_test(tiles_do_not_change_pixels),
        cmocka_unit_test(linking_is_told_where_a_program_is_new),
        cmocka_unit_test(a_stopped_frame_is_rendered_anew),
        cmocka_unit_test(grey_and_rgb_give_equal_pictures_of_a_grey_scene),
        cmocka_unit_test(the_camera_looks_where_its_matrices_say),
        cmocka_unit_test(an_absorbing_ball_follows_beer_and_lambert),
        cmocka_unit_test(a_furnace_shows_nothing),
        cmocka_unit_test(a_light_is_brighter_where_forward_scattering_leads_to_the_eye),
        cmocka_unit_test(backends_agree),
        cmocka_unit_test(a_march_that_the_driver_cuts_is_an_error),
        cmocka_unit_test_setup_teardown(a_broken_module_is_named_with_its_line, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test(a_camera_that_cannot_look_is_an_error),
        cmocka_unit_test(places_in_every_drivers_log_become_module_names),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
