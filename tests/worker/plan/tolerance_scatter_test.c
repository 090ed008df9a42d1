// Frames of several orders of scattering keep their tolerance.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/job/job_layers.h"
#include "core/job/step_check.h"
#include "tests/support/gl_stage.h"
#include "tests/support/json_edit.h"
#include "tests/support/plan_keeper.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_lookup.h"
#include "worker/plan/tolerance.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 24, HEIGHT_PX = 18, PIXELS = WIDTH_PX * HEIGHT_PX };

static const char JOB[] =
    "{\"version\":1,\"name\":\"white\",\"frames\":\"0\",\"fps\":24,\"resolution\":[24,18],"
    "\"camera\":{\"position\":[0.6,0.8,4],\"target\":[0,0,0],\"fov\":33},"
    "\"lights\":[{\"kind\":\"point\",\"position\":[2,2.5,1.5],\"intensity\":20}%s],"
    "\"scene\":{\"scattering\":{\"orders\":\"all\"},\"media\":[{\"density\":%s,\"sigma_s\":%s,\"sigma_a\":0.1,"
    "\"phase\":[{\"g\":0.5}]}]},"
    "\"quality\":{\"tolerance\":%g},\"output\":{\"path\":\"white.####.exr\",\"pixel\":\"float\"}}";
static const char BALL[] = "{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}";
static const char NOISE[] = "{\"kind\":\"noise\",\"frequency\":1.5,\"octaves\":2,\"bounds\":{\"kind\":\"sphere\","
                            "\"radius\":1,\"falloff\":0.3}}";
static const char FINE_NOISE[] = "{\"kind\":\"noise\",\"frequency\":12,\"octaves\":2,\"bounds\":{\"kind\":\"sphere\","
                                 "\"radius\":1,\"falloff\":0.3}}";

// The frame's relative RMSE in PIXELS of its pixels, by the product of its differences to two halves of the light.
static double measure_error(const struct job *job, const struct image *image)
{
    const struct integrate_accuracy accuracy = {.relative = fmax(0.02, 0.25 * job->quality.tolerance), .floor = 0.02};
    struct error error = {{0}};
    struct truth *truth = truth_open(&(struct truth_params){.job = job}, &error);
    struct truth_pixel light[PIXELS];
    struct pixel points[PIXELS];
    double square = 0.0, all = 0.0;

    if (!truth) fail_msg("%s", error.message);
    for (int i = 0; i < PIXELS; i++)
        points[i] = (struct pixel){i % WIDTH_PX * job->width_px / WIDTH_PX, i / WIDTH_PX * job->height_px / HEIGHT_PX};
    truth_measure_many(truth,
                       &(struct truth_many){.points = points, .pixels = light, .count = PIXELS, .accuracy = &accuracy});
    for (int i = 0; i < 3 * PIXELS; i++) {
        const struct truth_pixel *pixel = &light[i / 3];
        int at = points[i / 3].y * job->width_px + points[i / 3].x;
        double off = image->rgba[4 * at + i % 3] - pixel->rgb[i % 3], half = pixel->half[i % 3];

        square += off * off - half * half;
        all += pixel->rgb[i % 3] * pixel->rgb[i % 3] - half * half;
    }
    truth_close(truth);
    return sqrt(fmax(square, 0.0) / all);
}

// Alpha is a march's: it has no noise of paths, whatever the tolerance.
static void assert_alpha_is_fine(const struct job *job, struct renderer *renderer, const struct image *image)
{
    struct job fine = job_layers_seen(job);
    struct renderer_result result;
    struct error error = {{0}};
    struct image marched;

    fine.quality.step = 0.001;
    assert_true(image_init(&marched, job->width_px, job->height_px, false, false, NULL));
    if (!renderer_render(renderer, &(struct renderer_frame){.job = &fine, .image = &marched}, &result, &error))
        fail_msg("%s", error.message);
    for (size_t i = 3; i < 4 * (size_t)job->width_px * (size_t)job->height_px; i += 4)
        assert_true(fabsf(image->rgba[i] - marched.rgba[i]) < 2e-3F);
    image_finish(&marched);
}

static double foretold_s;

static void on_planned(void *user, double render_s)
{
    (void)user;
    foretold_s = render_s;
}

// Returns what the frame was rendered with. `objects` may be NULL.
static struct job_quality check_with(const char *density, const char *sigma_s, const char *sky, double allowed,
                                     const char *objects)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct tolerance *tolerance = tolerance_create(stage.renderer);
    struct tolerance_result result;
    struct error error = {{0}};
    struct image image;
    struct job job;
    char text[2048], *edited;
    double found;

    snprintf(text, sizeof text, JOB, sky, density, sigma_s, allowed);
    edited = objects ? json_edit_set(text, "scene.objects", objects) : xstrdup(text);
    if (!job_parse(&job, edited, strlen(edited), NULL, &error)) fail_msg("%s", error.message);
    free(edited);
    assert_true(image_init(&image, job.width_px, job.height_px, false, false, NULL));
    foretold_s = 0.0;
    if (!tolerance_render(
            tolerance, &(struct tolerance_params){.job = &job, .serial = 1, .image = &image, .on_planned = on_planned},
            &result, &error))
        fail_msg("%s", error.message);
    found = measure_error(&job, &image);
    print_message("tolerance %g: truly %.2e, audited %.2e (at most %.2e), %d cells, %d paths, %.2g of %.2g s: %s\n",
                  allowed, found, result.audit.error, result.audit.error95, result.quality.scatter_grid,
                  result.quality.paths, foretold_s, result.render.seconds, result.reason);
    assert_true(foretold_s > 0.0 && isfinite(foretold_s));
    assert_int_equal(result.retry_count, 0);
    assert_true(result.audit.error <= allowed);
    assert_true(found <= 1.25 * allowed);
    assert_true(found <= result.audit.error95);
    if (!scene_density_is_even(&job.scene.media[0].density) && step_has_end(&job))
        assert_alpha_is_fine(&job, stage.renderer, &image);
    image_finish(&image);
    job_finish(&job);
    tolerance_destroy(tolerance);
    gl_stage_close(stage);
    return result.quality;
}

static void check(const char *density, const char *sigma_s, const char *sky, double allowed)
{
    (void)check_with(density, sigma_s, sky, allowed, NULL);
}

static void a_white_ball_keeps_its_tolerance(void **state)
{
    check(BALL, "2", "", 0.1);
    check(BALL, "[1, 2, 4]", "", 0.05);
}

static void white_noise_keeps_its_tolerance(void **state)
{
    check(NOISE, "5", "", 0.05);
}

// A path from the camera through what is thick is far shorter than a walk from a node inside. Counted alike, both would
// cost as much.
static void small_pictures_of_thick_media_have_paths(void **state)
{
    assert_int_equal(check_with(BALL, "10", "", 0.05, NULL).method, JOB_METHOD_PATHS);
    (void)state;
}

static void media_under_a_sky_keep_their_tolerance(void **state)
{
    check(NOISE, "5", ",{\"kind\":\"dome\",\"gradient\":{\"along\":[0.2,0.4,0.9],\"against\":0.5},\"visible\":true}",
          0.05);
    check(BALL, "3", ",{\"kind\":\"sphere\",\"position\":[-2,0,2],\"radius\":0.5,\"intensity\":9}", 0.1);
}

// No march with a grid of scattered light shows surfaces: paths do, with what lamps send looked up.
static void noise_over_a_floor_has_light_grids(void **state)
{
    static const char floor[] = "[{\"kind\":\"plane\",\"point\":[0,-1.1,0],\"material\":{\"kind\":\"diffuse\","
                                "\"albedo\":[0.8,0.5,0.3]}}]";
    struct job_quality quality = check_with(NOISE, "5", "", 0.1, floor);

    (void)state;
    assert_int_equal(quality.method, JOB_METHOD_PATHS);
    assert_in_range(quality.light_grid, 45, 256);
}

// A march through haze that nothing bounds has no end: there is no plan of the first order, and paths show it all.
static void endless_haze_keeps_its_tolerance(void **state)
{
    static const char haze[] = "{\"kind\":\"noise\",\"frequency\":1,\"octaves\":2,\"mode\":\"remap\"}";

    (void)state;
    assert_int_equal(check_with(haze, "0.3", "", 0.3, NULL).method, JOB_METHOD_PATHS);
}

// Air is thinner than the cells of a grid of 64 around its planet.
static void thin_air_has_no_light_grids(void **state)
{
    static const char AIR[] = "{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1.02,"
                              "\"falloff\":0.01}}";
    struct job_quality quality = check_with(AIR, "[12, 27, 66]", "", 0.1,
                                            "[{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,"
                                            "\"material\":{\"kind\":\"diffuse\",\"albedo\":0.2}}]");

    assert_int_equal(quality.method, JOB_METHOD_PATHS);
    assert_int_equal(quality.light_grid, 0);
    (void)state;
}

// What another worker is told of a plan is the same plan.
static void a_grid_from_the_lights_is_looked_up(void **state)
{
    struct plan_point point = {.rungs = {4, 4, 4, 4, 4, 4}, .is_from_lights = 1}, found;
    struct error error = {{0}};
    struct job_quality quality;
    struct plan_scene scene;
    struct job job;
    char text[2048];
    size_t family = 0, looked_up;

    snprintf(text, sizeof text, JOB, "", NOISE, "5", 0.1);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    plan_scene_init(&scene, &job);
    while (strcmp(plan_families[family].name, "midpoint") != 0)
        family++;
    quality = plan_family_quality(&plan_families[family], &scene, &point);
    // Only walks from the nodes know similar media.
    assert_true(quality.scatter_from == JOB_SCATTER_FROM_LIGHTS && quality.similar_after == 0);
    assert_true(plan_lookup(&scene, &quality, &looked_up, &found));
    assert_true(looked_up == family && found.is_from_lights == 1);
    point.is_from_lights = 0;
    quality = plan_family_quality(&plan_families[family], &scene, &point);
    assert_true(quality.scatter_from == JOB_SCATTER_FROM_ANY && quality.similar_after > 0);
    assert_true(plan_lookup(&scene, &quality, &looked_up, &found));
    assert_true(looked_up == family && found.is_from_lights == 0);
    job_finish(&job);
    (void)state;
}

static int fills;

static void count_fills(enum log_level level, const struct log_subject *subject, const char *line)
{
    (void)level;
    (void)subject;
    fills += strstr(line, "caches: scatter_means") != NULL;
}

// The look at a stated job's first pixels leaves the grid that the frame needs.
static void a_stated_grid_is_filled_once(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct tolerance *tolerance = tolerance_create(stage.renderer);
    struct tolerance_result result;
    struct error error = {{0}};
    struct image image;
    struct job job;
    char text[2048];

    snprintf(text, sizeof text, JOB, "", BALL, "2", 0.05);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    job.quality = (struct job_quality){.method = JOB_METHOD_MIDPOINT,
                                       .step = 0.1,
                                       .light_step = 0.1,
                                       .scatter_grid = 4,
                                       .paths = 16,
                                       .samples = 1,
                                       .max_cut = 1.0};
    assert_true(image_init(&image, job.width_px, job.height_px, false, false, NULL));
    fills = 0;
    log_set_level(LOG_DEBUG);
    log_set_sink(count_fills);
    if (!tolerance_render(tolerance, &(struct tolerance_params){.job = &job, .serial = 1, .image = &image}, &result,
                          &error))
        fail_msg("%s", error.message);
    log_set_sink(NULL);
    log_set_level(LOG_INFO);
    assert_int_equal(fills, 1);
    image_finish(&image);
    job_finish(&job);
    tolerance_destroy(tolerance);
    gl_stage_close(stage);
    (void)state;
}

// The plan of a long segment measures its own frames once, in other pixels than those by which it was chosen: a frame
// is then judged by few of its own. In a short one that would cost more than it saves.
static void frames_of_long_segments_share_their_samples(void **state)
{
    static const char *const frames[] = {"\"0-11\"", "\"0-10\""};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct tolerance *tolerance = tolerance_create(stage.renderer);

    (void)state;
    for (int is_short = 0; is_short < 2; is_short++) {
        struct tolerance_result result;
        struct error error = {{0}};
        struct image image;
        struct job job;
        char text[2048], *sized, *edited;
        double found;

        // A black lamp moves: frames are alike and have random numbers of their own. Of 25 such frames, which differ by
        // the place of that lamp, the bound held for 24; z of 9 is the other one.
        snprintf(text, sizeof text, JOB,
                 ",{\"kind\":\"point\",\"intensity\":0,\"position\":{\"lissajous\":{\"amplitude\":[1,1,1],"
                 "\"frequency_rad\":[3,2,4],\"center\":[9,9,10]}}}",
                 NOISE, "5", 0.05);
        // Fewer pixels would have paths of their own.
        sized = json_edit_set(text, "resolution", "[96,72]");
        edited = json_edit_set(sized, "frames", frames[is_short]);
        free(sized);
        if (!job_parse(&job, edited, strlen(edited), NULL, &error)) fail_msg("%s", error.message);
        free(edited);
        assert_true(image_init(&image, job.width_px, job.height_px, false, false, NULL));
        if (!tolerance_render(
                tolerance, &(struct tolerance_params){.job = &job, .serial = 1 + is_short, .frame = 3, .image = &image},
                &result, &error))
            fail_msg("%s", error.message);
        assert_true(result.quality.scatter_grid > 0);
        assert_int_equal(result.audit.is_pooled, !is_short);
        assert_true(is_short || result.audit.ray_count > 3 * 16 * 5);
        found = measure_error(&job, &image);
        print_message("truly %.2e, audited %.2e (at most %.2e) by %d pixels, rendered %d times more: %s\n", found,
                      result.audit.error, result.audit.error95, result.audit.ray_count, result.retry_count,
                      result.reason);
        assert_true(found <= fmin(1.25 * 0.05, result.audit.error95));
        image_finish(&image);
        job_finish(&job);
    }
    tolerance_destroy(tolerance);
    gl_stage_close(stage);
}

// A plan whose march is far too coarse for a frame: that is refined, and neither cells nor walks, which suffice.
static void a_march_that_misses_is_refined(void **state)
{
    const struct plan_point coarse = {.rungs = {0, 7, 4, 5, 16}};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct tolerance *tolerance = tolerance_create(stage.renderer);
    struct plan_keeper keeper = {.plan = {.cells_square = 1e-5, .paths_square = 1e-5}, .number = 1};
    const struct plan_source source = plan_keeper_source(&keeper);
    struct tolerance_result result;
    struct job_quality first;
    struct plan_scene scene;
    struct error error = {{0}};
    struct image image;
    struct job job;
    char text[2048];
    size_t family = 0;

    (void)state;
    snprintf(text, sizeof text, JOB, "", FINE_NOISE, "2", 0.05);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    plan_scene_init(&scene, &job);
    while (plan_families[family].method != JOB_METHOD_MIDPOINT)
        family++;
    first = plan_family_quality(&plan_families[family], &scene, &coarse);
    keeper.plan.quality = keeper.plan.view_quality = first;
    assert_true(image_init(&image, job.width_px, job.height_px, false, false, NULL));
    if (!tolerance_render(tolerance,
                          &(struct tolerance_params){.job = &job, .serial = 1, .image = &image, .source = &source},
                          &result, &error))
        fail_msg("%s", error.message);
    print_message("step %g to %g, %d to %d cells, %d to %d paths: error %.2e to %.2e\n", first.step,
                  result.quality.step, first.scatter_grid, result.quality.scatter_grid, first.paths,
                  result.quality.paths, result.first_error, result.audit.error);
    assert_true(result.quality.step < 0.6 * first.step);
    assert_int_equal(result.quality.scatter_grid, first.scatter_grid);
    assert_int_equal(result.retry_count, 1);
    assert_true(result.first_error > 0.05 && result.audit.error <= 0.05);
    assert_true(measure_error(&job, &image) <= 1.25 * 0.05);
    image_finish(&image);
    job_finish(&job);
    tolerance_destroy(tolerance);
    gl_stage_close(stage);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thin_air_has_no_light_grids),
        cmocka_unit_test(a_grid_from_the_lights_is_looked_up),
        cmocka_unit_test(a_stated_grid_is_filled_once),
        cmocka_unit_test(a_white_ball_keeps_its_tolerance),
        cmocka_unit_test(white_noise_keeps_its_tolerance),
        cmocka_unit_test(small_pictures_of_thick_media_have_paths),
        cmocka_unit_test(media_under_a_sky_keep_their_tolerance),
        cmocka_unit_test(noise_over_a_floor_has_light_grids),
        cmocka_unit_test(endless_haze_keeps_its_tolerance),
        cmocka_unit_test(frames_of_long_segments_share_their_samples),
        cmocka_unit_test(a_march_that_misses_is_refined),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
