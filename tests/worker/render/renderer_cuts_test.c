// Rays that no surface ends are followed, counted and cut as closed forms say.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/assert_near.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// Two mirrors that face each other, with the camera between them: rays neither split nor escape.
#define HALL                                                                                                           \
    "{\"kind\": \"plane\", \"point\": [0, 0, -1], \"normal\": [0, 0, 1], \"material\": {\"kind\": \"mirror\", "        \
    "\"reflectance\": %s}}, {\"kind\": \"plane\", \"point\": [0, 0, 1], \"normal\": [0, 0, -1], \"material\": "        \
    "{\"kind\": \"mirror\", \"reflectance\": %s}}"
// A pane that reflects a quarter at every angle and fills the view.
#define PANE                                                                                                           \
    "{\"kind\": \"box\", \"center\": [0, 0, 2], \"size\": [1000, 1000, 1], \"material\": {\"kind\": \"dielectric\", "  \
    "\"ior\": 1.5, \"fresnel\": \"schlick\", \"f0\": 0.25, \"f90\": 0.25}}"

// Makes a job whose camera looks along z, with the same counts of rays in each pixel. Free with job_finish.
static struct job make_job(const char *media, const char *objects, const char *quality)
{
    struct error error = {{0}};
    struct job job;
    char *text =
        xasprintf("{\"version\": 1, \"name\": \"cuts\", \"frames\": \"0-9\", \"fps\": 24, \"resolution\": [9, 7],"
                  " \"camera\": {\"position\": [0, 0, 0], \"target\": [0, 0, 1], \"fov\": 1},"
                  " \"background\": 1, \"scene\": {\"media\": [%s], \"objects\": [%s]},"
                  " \"quality\": {\"method\": \"midpoint\", \"step\": 1, %s},"
                  " \"output\": {\"path\": \"cuts.####.exr\", \"pixel\": \"float\"}}",
                  media, objects, quality);

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    free(text);
    return job;
}

static struct job make_hall(const char *media, const char *reflectance, const char *quality)
{
    char *objects = xasprintf(HALL, reflectance, reflectance);
    struct job job = make_job(media, objects, quality);

    free(objects);
    return job;
}

static struct renderer_result render(struct gl_stage *stage, const struct job *job, int32_t frame, float color[4])
{
    struct error error = {{0}};
    struct renderer_result result;
    struct image image;

    assert_true(image_init(&image, job->width_px, job->height_px, false, false, NULL));
    if (!renderer_render(stage->renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = &image},
                         &result, &error))
        fail_msg("%s", error.message);
    memcpy(color, image.rgba, 4 * sizeof *color);
    image_finish(&image);
    return result;
}

struct expectation {
    double rays, cut_rays, cut_throughput, by_depth, color;
};

static void assert_counts(enum gl_backend backend, struct job job, const struct expectation *expected)
{
    struct gl_stage stage = gl_stage_open(backend, test_shader_dir());
    float color[4];
    struct renderer_result result = render(&stage, &job, 0, color);
    const struct ray_counts *counts = &result.ray_counts;

    assert_true(counts->is_known);
    assert_near(counts->rays, expected->rays, 1e-9);
    assert_near(counts->cut_rays, expected->cut_rays, 1e-9);
    // The tolerance is a float's rounding at each surface.
    assert_near(counts->cut_throughput, expected->cut_throughput, 1e-6 * expected->cut_throughput);
    assert_near(counts->cut_by_depth, expected->by_depth, 1e-6 * expected->cut_throughput);
    assert_near(counts->cut_share, expected->cut_throughput, 1e-5 * expected->cut_throughput);
    assert_near(counts->most_rays.value, expected->rays, 0);
    assert_near(color[0], expected->color, 1e-6);
    job_finish(&job);
    gl_stage_close(stage);
}

static void a_hall_of_mirrors_is_cut_at_its_depth(void **state)
{
    for (int depth = 1; depth <= 9; depth += 4) {
        double left = pow(0.5, depth + 1);
        char quality[64];

        snprintf(quality, sizeof quality, "\"max_depth\": %d", depth);
        assert_counts(GL_BACKEND_SOFTWARE, make_hall("", "0.5", quality),
                      &(struct expectation){depth + 1, 1, left, depth < 9 ? left : 0, 0});
    }
}

static void a_hall_of_mirrors_is_cut_where_little_is_left(void **state)
{
    // A ray exactly at the limit is followed.
    assert_counts(GL_BACKEND_SOFTWARE, make_hall("", "0.5", "\"min_throughput\": 0.25"),
                  &(struct expectation){3, 1, 0.125, 0, 0});
    assert_counts(GL_BACKEND_SOFTWARE, make_hall("", "0.5", "\"min_throughput\": 0.2501"),
                  &(struct expectation){2, 1, 0.25, 0, 0});
}

static void the_strongest_colour_decides_and_all_are_counted(void **state)
{
    assert_counts(GL_BACKEND_SOFTWARE, make_hall("", "[0, 0.5, 0.25]", "\"max_depth\": 8, \"min_throughput\": 0.2"),
                  &(struct expectation){3, 1, (0.125 + 0.015625) / 3, 0, 0});
    assert_counts(GL_BACKEND_SOFTWARE, make_hall("", "[0, 0.5, 0.25]", "\"max_depth\": 1, \"min_throughput\": 0.2"),
                  &(struct expectation){2, 1, (0.25 + 0.0625) / 3, (0.25 + 0.0625) / 3, 0});
}

static void media_on_the_way_count(void **state)
{
    static const char *const fog = "{\"sigma_a\": 0.5, \"sigma_s\": 0, \"density\": {\"kind\": \"homogeneous\"}}";
    struct job job = make_hall(fog, "0.5", "\"max_depth\": 2");
    double left = 0.125 * exp(-0.5 * 5); // 1 m to the first mirror, then 2 m each
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    float color[4];
    struct renderer_result result = render(&stage, &job, 0, color);

    // Rays at half the angle of view, 0.6 degrees, are longer by 6e-5.
    assert_near(result.ray_counts.cut_throughput, left, 2e-4 * left);
    assert_near(result.ray_counts.rays, 3, 0);
    job_finish(&job);
    gl_stage_close(stage);
}

// Inside the pane a ray of depth k has throughput (1 - F) F^(k-1) and splits in two. The rays that the last one would
// send are cut.
static void assert_pane(enum gl_backend backend, const char *samples)
{
    for (int depth = 1; depth <= 5; depth += 2) {
        double left = 0.75 * pow(0.25, depth - 1);
        char quality[64];

        snprintf(quality, sizeof quality, "\"max_depth\": %d, \"min_throughput\": 0%s", depth, samples);
        assert_counts(backend, make_job("", PANE, quality),
                      &(struct expectation){2 * depth + 1, 2, left, left, 1 - left});
    }
}

static void a_pane_sends_two_rays_on_at_each_face(void **state)
{
    assert_pane(GL_BACKEND_SOFTWARE, "");
}

static void a_pane_does_so_on_egl(void **state)
{
    assert_pane(GL_BACKEND_EGL, "");
}

static void counts_are_means_of_samples(void **state)
{
    assert_pane(GL_BACKEND_SOFTWARE, ", \"samples\": 4");
}

static void a_copied_frame_keeps_its_counts(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct job job = make_job("", PANE, "\"max_depth\": 3");
    float color[4];
    struct renderer_result first = render(&stage, &job, 0, color), second = render(&stage, &job, 1, color);

    assert_true(!first.is_copy && second.is_copy);
    assert_near(second.ray_counts.rays, 7, 0);
    assert_memory_equal(&first.ray_counts, &second.ray_counts, sizeof first.ray_counts);
    job_finish(&job);
    gl_stage_close(stage);
}

static bool count_tiles(void *user, double done)
{
    ++*(int *)user;
    return true;
}

// Panes behind one another split rays faster than the depth limit ends them. The frame fails at its first tile.
static void more_rays_than_the_driver_follows_are_an_error(void **state)
{
    enum { WIDTH = 16, HEIGHT = 96 };
    static const char pane[] = "{\"kind\": \"box\", \"center\": [0, 0, %d], \"size\": [99, 99, 0.5], \"material\": "
                               "{\"kind\": \"dielectric\", \"ior\": 3}}";
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct error error = {{0}};
    struct image image;
    char panes[4][160], *objects;
    int tiles = 0;
    struct job job;

    for (int i = 0; i < 4; ++i)
        snprintf(panes[i], sizeof panes[i], pane, i + 2);
    objects = xasprintf("%s, %s, %s, %s", panes[0], panes[1], panes[2], panes[3]);
    job = make_job("", objects, "\"max_depth\": 32, \"min_throughput\": 0");
    job.width_px = WIDTH;
    job.height_px = HEIGHT;
    assert_true(image_init(&image, WIDTH, HEIGHT, false, false, NULL));
    assert_false(renderer_render(
        stage.renderer,
        &(struct renderer_frame){.job = &job, .frame = 0, .image = &image, .on_progress = count_tiles, .user = &tiles},
        &result, &error));
    assert_int_equal(result.fault, RENDERER_FAULT_ENDLESS);
    assert_int_equal(tiles, 0);
    assert_non_null(strstr(error.message, "a smaller max_depth, a larger min_throughput"));
    free(objects);
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
}

static void scenes_follow_one_another_with_and_without_paths(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct job glass = make_job("", PANE, "\"max_depth\": 3");
    struct job floor = make_job("",
                                "{\"kind\": \"plane\", \"point\": [0, 0, 1], \"normal\": [0, 0, -1], \"material\": "
                                "{\"kind\": \"diffuse\", \"albedo\": 0.5}}",
                                "\"max_depth\": 3");

    for (int i = 0; i < 4; ++i) {
        float color[4];
        struct renderer_result result = render(&stage, i % 2 ? &floor : &glass, 0, color);

        assert_false(result.is_copy);
        assert_true(result.ray_counts.is_known == (i % 2 == 0));
        assert_near(result.ray_counts.rays, i % 2 ? 0 : 7, 0);
        assert_near(color[0], i % 2 ? 0 : 1 - 0.75 / 16, 1e-6);
    }
    job_finish(&glass);
    job_finish(&floor);
    gl_stage_close(stage);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hall_of_mirrors_is_cut_at_its_depth),
        cmocka_unit_test(a_hall_of_mirrors_is_cut_where_little_is_left),
        cmocka_unit_test(the_strongest_colour_decides_and_all_are_counted),
        cmocka_unit_test(media_on_the_way_count),
        cmocka_unit_test(a_pane_sends_two_rays_on_at_each_face),
        cmocka_unit_test(a_pane_does_so_on_egl),
        cmocka_unit_test(counts_are_means_of_samples),
        cmocka_unit_test(a_copied_frame_keeps_its_counts),
        cmocka_unit_test(more_rays_than_the_driver_follows_are_an_error),
        cmocka_unit_test(scenes_follow_one_another_with_and_without_paths),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
