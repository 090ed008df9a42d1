// Sparse pixels before a sky of detail: media are interpolated, and what is seen through them is not.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "core/job/job_layers.h"
#include "tests/support/bias_check.h"
#include "tests/support/exr_maker.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "tests/support/sparse_pair.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/pixel.h"
#include "worker/render/renderer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define NOISE                                                                                                          \
    "{ \"sigma_s\": [2, 1, 3], \"sigma_a\": [0.2, 1, 0.5], \"density\": { \"kind\": \"noise\", \"frequency\": 2.5,"    \
    " \"octaves\": 2, \"H\": 0.6, \"lacunarity\": 2, \"bias\": 0.2, \"mode\": \"clip\", \"scale\": 4, \"bounds\":"     \
    " { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9, \"falloff\": 0.3 } } }"

enum { WIDE = 192, HIGH = 144, PIXELS = WIDE * HIGH };
static const struct job_pixels SPARSE = {8, 0.03};

struct test_scene {
    struct gl_stage stage;
    struct job job;
};

// Fields of light and dark, a few pixels each.
static struct test_scene open_scene(void **state, const char *quality)
{
    enum { WIDTH = 128, HEIGHT = 64 };
    static float rgb[3 * WIDTH * HEIGHT];
    struct test_scene scene = {.stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir())};
    const char *path = temp_folder_path(state, "fields.exr");
    char light[512];

    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        rgb[i] = ((i / 3 % WIDTH) / 2 + i / 3 / WIDTH / 2) % 2 ? 1.5F : 0.1F;
    exr_maker_write(path, WIDTH, HEIGHT, JOB_PIXEL_FLOAT, rgb);
    snprintf(light, sizeof light, "{ \"kind\": \"dome\", \"file\": \"%s\", \"visible\": true },", path);
    bias_check_parse(&scene.job,
                     &(struct bias_check_scene){
                         .media = NOISE, .lights = light, .quality = quality, .background = "", .orders = "\"all\""});
    scene.job.width_px = WIDE;
    scene.job.height_px = HIGH;
    return scene;
}

static void close_scene(struct test_scene *scene)
{
    gl_stage_close(scene->stage);
    job_finish(&scene->job);
}

static void assert_few_pixels_suffice(struct renderer *renderer, const struct job *job)
{
    struct sparse_pair pair;
    double error, traced;

    sparse_pair_render(renderer, job, 0, SPARSE, &pair);
    error = sparse_pair_error(&pair);
    traced = pair.sparse_result.traced;
    print_message("%d samples: %.1f %% traced, error %.2e\n", job->quality.samples, 100 * traced, error);
    assert_true(error <= 0.15 * SPARSE.threshold);
    assert_true(traced < 0.5);
    for (size_t i = 0; i < PIXELS; i++)
        assert_true(pair.sparse.rgba[4 * i + 3] == 1.0F);
    sparse_pair_finish(&pair);
}

#define GRID "\"method\": \"midpoint\", \"step\": 0.02, \"light_step\": 0.1, \"scatter_grid\": 8, \"paths\": 16"

static void media_alone_are_interpolated(void **state)
{
    struct test_scene scene = open_scene(state, GRID);
    struct job seen;

    assert_few_pixels_suffice(scene.stage.renderer, &scene.job);
    scene.job.quality.samples = 4;
    assert_few_pixels_suffice(scene.stage.renderer, &scene.job);
    // What is seen beside paths.
    scene.job.quality.samples = 1;
    scene.job.quality.scatter_grid = 0;
    seen = job_layers_seen(&scene.job);
    assert_few_pixels_suffice(scene.stage.renderer, &seen);
    close_scene(&scene);
}

// Depth and transmittance are those of the march without the dome behind, and its doubts.
static void what_media_let_pass_is_the_marchs(void **state)
{
    struct test_scene scene = open_scene(state, GRID);
    struct renderer_result result;
    struct image both, lit;
    struct job hidden;

    scene.job.quality.pixels = SPARSE;
    hidden = job_layers_lit(&scene.job);
    both = sparse_pair_frame(scene.stage.renderer, &scene.job, 0, SPARSE, &result);
    lit = sparse_pair_frame(scene.stage.renderer, &hidden, 0, SPARSE, &result);
    assert_non_null(both.doubts);
    assert_memory_equal(both.depth, lit.depth, PIXELS * sizeof(float));
    assert_memory_equal(both.transmittance, lit.transmittance, 4 * PIXELS * sizeof(float));
    assert_memory_equal(both.doubts, lit.doubts, PIXELS);
    for (size_t i = 0; i < PIXELS; i++)
        assert_true(both.cut[i] == 0.0F);
    image_finish(&both);
    image_finish(&lit);
    close_scene(&scene);
}

// A pixel of a list is that of the whole frame, to the bit where it was traced there.
static void listed_pixels_are_those_of_frames(void **state)
{
    enum { POINTS = 24 };
    struct test_scene scene = open_scene(state, GRID);
    struct pixel points[POINTS];
    struct renderer_result result;
    struct image whole, list;
    size_t count = 0;

    scene.job.quality.pixels = SPARSE;
    whole = sparse_pair_frame(scene.stage.renderer, &scene.job, 0, SPARSE, &result);
    for (int i = 0; i < PIXELS && count < POINTS; i += 8)
        if (whole.doubts[i] == 0 && whole.transmittance[4 * i] < 0.9F)
            points[count++] = (struct pixel){i % WIDE, i / WIDE};
    assert_int_equal(count, POINTS);
    assert_true(image_init(&list, POINTS, 1, true, true, NULL));
    assert_true(renderer_render(
        scene.stage.renderer,
        &(struct renderer_frame){.job = &scene.job, .pixels = points, .pixel_count = POINTS, .image = &list}, &result,
        NULL));
    for (size_t i = 0; i < POINTS; i++) {
        size_t at = (size_t)points[i].y * WIDE + (size_t)points[i].x;

        assert_memory_equal(list.rgba + 4 * i, whole.rgba + 4 * at, 4 * sizeof(float));
        assert_memory_equal(list.transmittance + 4 * i, whole.transmittance + 4 * at, 3 * sizeof(float));
        assert_true(list.depth[i] == whole.depth[at]);
    }
    image_finish(&whole);
    image_finish(&list);
    close_scene(&scene);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(media_alone_are_interpolated, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(what_media_let_pass_is_the_marchs, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(listed_pixels_are_those_of_frames, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
