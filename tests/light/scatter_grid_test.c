// Grids of scattered light: against reference/ in every march and medium, and the same pictures whoever renders them.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/bias_check.h"
#include "tests/support/exr_maker.h"
#include "tests/support/gl_stage.h"
#include "tests/support/render_frame.h"
#include "tests/support/shader_dir.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define BALL "\"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9"
#define COLOURED "\"sigma_s\": [2, 1, 3], \"sigma_a\": [0.2, 1, 0.5]"
#define EVEN "{ " COLOURED ", \"density\": { \"kind\": \"homogeneous\", " BALL " } } }"
#define LOBE(G)                                                                                                        \
    "\"phase\": [ { \"g\": " G ", \"weight\": 1 } ], \"density\": { \"kind\": \"homogeneous\", " BALL " } } }"
#define FORWARD "{ \"sigma_s\": 4, \"sigma_a\": 0.1, " LOBE("0.6")
#define RAYLEIGH                                                                                                       \
    "{ " COLOURED ", \"phase\": [ { \"kind\": \"rayleigh\", \"weight\": 0.7 }, { \"g\": -0.6, \"weight\": 0.3 } ],"    \
    " \"density\": { \"kind\": \"homogeneous\", " BALL ", \"falloff\": 0.8 } } }"
#define NOISE                                                                                                          \
    "{ " COLOURED ", \"emission\": [0.1, 0.2, 0.3], \"phase\": [ { \"g\": 0.4, \"weight\": 1 } ], \"density\": {"      \
    " \"kind\": \"noise\", \"frequency\": 2.5, \"octaves\": 2, \"H\": 0.6, \"lacunarity\": 2, \"bias\": 0.2,"          \
    " \"mode\": \"clip\", \"scale\": 4, " BALL ", \"falloff\": 0.3 } } }"
#define FRACTAL                                                                                                        \
    "{ \"density\": { \"kind\": \"fold_fractal\", \"iterations\": 3, \"offset\": 0.05, \"radius\": 0.4,"               \
    " \"rotate_x_rad\": 0.3, \"rotate_y_rad\": 0.7, \"exponent\": 1.3, \"scale\": 12 }, " COLOURED " }"
#define GLOW                                                                                                           \
    "{ \"sigma_s\": 0, \"sigma_a\": 0, \"emission\": [1, 0.4, 0.1], \"density\": { \"kind\": \"homogeneous\","         \
    " \"bounds\": { \"kind\": \"box\", \"center\": [0.4, 0.2, 0], \"size\": [0.7, 0.6, 0.5], \"falloff\": 0.2 } } }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": [3, 2, 1], \"direction\": [-1, -2, 0.5] },"
#define LAMP "{ \"kind\": \"point\", \"intensity\": [1, 3, 2], \"position\": [1.2, 1, 0.9] },"
#define SPOT                                                                                                           \
    "{ \"kind\": \"spot\", \"intensity\": 20, \"position\": [0, 2.5, 1], \"direction\": [0, -2.5, -1], \"inner\": 5,"  \
    " \"outer\": 20 },"
#define SKY "{ \"kind\": \"dome\", \"radiance\": 1 },"
#define GRADIENT                                                                                                       \
    "{ \"kind\": \"dome\", \"gradient\": { \"along\": [2, 1, 0.5], \"against\": 0.2, \"axis\": [1, 2, 0] } },"
#define GRID ", \"scatter_grid\": 16, \"paths\": 1024"
#define CACHED "\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 48" GRID
#define COARSE "\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 48, \"scatter_grid\": 12, \"paths\": 512"
#define FROM_LIGHTS "\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 48, \"scatter_from\": \"lights\""
#define LIGHTS FROM_LIGHTS ", \"scatter_grid\": 20, \"paths\": 128"
#define INSIDE "{ \"kind\": \"point\", \"intensity\": [1, 3, 2], \"position\": [0.3, -0.2, 0.25] },"
#define FLAT "{ \"kind\": \"point\", \"falloff\": \"none\", \"intensity\": [1, 3, 2], \"position\": [1.2, 1, 0.9] },"
#define SPHERE "{ \"kind\": \"sphere\", \"intensity\": [3, 2, 4], \"position\": [1.5, 0.5, 0.9], \"radius\": 0.4 },"
#define SPOT_INSIDE                                                                                                    \
    "{ \"kind\": \"spot\", \"intensity\": 5, \"position\": [0.3, 0.4, 0.1], \"direction\": [-1, -1, 0],"               \
    " \"inner\": 20, \"outer\": 45 },"

// The light of the scene at pixels' centres by reference/, with standard errors. The background is black.
struct truth {
    struct bias_check_scene scene;
    double light[BIAS_CHECK_VALUES], noise[BIAS_CHECK_VALUES];
};

static void find_truth(struct truth *truth, const char *media, const char *lights, const char *orders)
{
    truth->scene = (struct bias_check_scene){.media = media, .lights = lights, .orders = orders, .background = "0"};
    truth->scene.quality = "\"method\": \"paths\", \"paths\": 1";
    bias_check_find_paths(&truth->scene, 4000, truth->light, truth->noise);
}

static void render_check(const struct bias_check_scene *scene, double light[BIAS_CHECK_VALUES])
{
    struct image image;
    struct job job;

    bias_check_parse(&job, scene);
    render_frame_zero(&job, &image);
    for (size_t i = 0; i < BIAS_CHECK_VALUES; ++i)
        light[i] = image.rgba[i / 3 * 4 + i % 3];
    image_finish(&image);
    job_finish(&job);
}

// The error is the root of the squared error over that of the light, without the noise of the truth.
static void assert_near_truth(const struct truth *truth, const char *quality, double limit)
{
    struct bias_check_scene scene = truth->scene;
    double light[BIAS_CHECK_VALUES], square = 0, own = 0, power = 0, off = 0, all = 0, error;

    scene.quality = quality;
    render_check(&scene, light);
    for (size_t i = 0; i < BIAS_CHECK_VALUES; ++i) {
        square += pow(light[i] - truth->light[i], 2);
        own += pow(truth->noise[i], 2);
        power += pow(truth->light[i], 2);
        off += light[i] - truth->light[i];
        all += truth->light[i];
    }
    error = sqrt(fmax(square - own, 0) / power);
    print_message("%.60s: error %.4f beside noise of the truth of %.4f, mean off by %+.4f\n", quality, error,
                  sqrt(own / power), off / all);
    if (!(error < limit)) fail_msg("%.4f, expected less than %.4f", error, limit);
    assert_true(fabs(off / all) < limit);
}

static void assert_true_to(const char *media, const char *lights, const char *orders, double limit)
{
    struct truth truth;

    find_truth(&truth, media, lights, orders);
    assert_near_truth(&truth, CACHED, limit);
}

// Without the orders above the first these would be 25 % to 70 % darker. The limits are twice what the cells and walks
// err by here.
static void all_orders_are_those_of_the_reference(void **state)
{
    (void)state;
    assert_true_to(EVEN, SUN, "2", 0.012);
    assert_true_to(EVEN, SUN LAMP, "\"all\"", 0.02);
    assert_true_to(FORWARD, SUN, "\"all\"", 0.04);
    assert_true_to(RAYLEIGH, LAMP, "\"all\"", 0.03);
    assert_true_to(NOISE, SUN, "\"all\"", 0.03);
    assert_true_to(EVEN ", " FRACTAL ", " GLOW, SUN LAMP, "3", 0.03);
    assert_true_to(EVEN, SPOT, "\"all\"", 0.03);
}

static void domes_are_those_of_the_reference(void **state)
{
    (void)state;
    assert_true_to(EVEN, GRADIENT, "1000", 0.015);
    assert_true_to(EVEN, GRADIENT, "2", 0.015);
    assert_true_to(NOISE, GRADIENT SUN, "\"all\"", 0.03);
}

// The limits are twice what the cells and 256 particles a node err by here: half of these err by 1.4 times as much.
static void assert_sent(const char *media, const char *lights, const char *orders, double limit)
{
    struct truth truth;

    find_truth(&truth, media, lights, orders);
    assert_near_truth(&truth, LIGHTS, limit);
}

// A sky with a sun of four texels, turned and coloured: of all its light that is one half.
static void images_of_skies_are_those_of_the_reference(void **state)
{
    enum { WIDTH = 32, HEIGHT = 16 };
    static float rgb[3 * HEIGHT * WIDTH];
    const char *path = temp_folder_path(state, "sky.exr");
    char light[512];

    for (int i = 0; i < HEIGHT * WIDTH; ++i) {
        bool is_sun = i / WIDTH / 2 == 2 && i % WIDTH / 2 == 10;

        for (int c = 0; c < 3; ++c)
            rgb[3 * i + c] = (is_sun ? 60.0f : i / WIDTH < HEIGHT / 2 ? 0.5f : 0.1f) * (1.0f + 0.3f * (float)c);
    }
    exr_maker_write(path, WIDTH, HEIGHT, JOB_PIXEL_FLOAT, rgb);
    snprintf(light, sizeof light,
             "{ \"kind\": \"dome\", \"file\": \"%s\", \"scale\": [0.5, 1, 2],"
             " \"rotate\": { \"axis\": [1, 3, 0.5], \"angle\": 70 } },",
             path);
    assert_true_to(FORWARD, light, "\"all\"", 0.022);
    assert_sent(EVEN, light, "\"all\"", 0.028);
}

struct stage {
    struct gl_stage gl;
    struct image image;
    struct renderer_result result;
};

static void render_on(struct stage *stage, const struct job *job)
{
    struct error error = {{0}};

    if (!renderer_render(stage->gl.renderer, &(struct renderer_frame){.job = job, .image = &stage->image},
                         &stage->result, &error))
        fail_msg("%s", error.message);
}

static struct stage open_stage(void)
{
    struct stage stage = {.gl = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir())};

    assert_true(image_init(&stage.image, BIAS_CHECK_WIDTH_PX, BIAS_CHECK_HEIGHT_PX, true, true, NULL));
    return stage;
}

static void close_stage(struct stage *stage)
{
    image_finish(&stage->image);
    gl_stage_close(stage->gl);
}

static void particles_from_lights_bring_all_orders(void **state)
{
    (void)state;
    assert_sent(EVEN, SUN, "2", 0.02);
    assert_sent(EVEN, SUN LAMP, "\"all\"", 0.02);
    assert_sent(FORWARD, SUN, "\"all\"", 0.05);
    assert_sent(RAYLEIGH, SPOT GRADIENT, "\"all\"", 0.017);
    assert_sent(EVEN ", " FRACTAL, FLAT, "3", 0.03);
}

static void particles_come_from_lamps_of_all_sizes(void **state)
{
    (void)state;
    assert_sent(EVEN, SPHERE, "2", 0.03);
    assert_sent(EVEN, SPHERE SKY, "\"all\"", 0.02);
    assert_sent(EVEN, INSIDE, "\"all\"", 0.06);
    assert_sent(EVEN, SPOT_INSIDE, "\"all\"", 0.04);
}

// The noise of a picture, whose finest twin has some of its own.
static double noise_beside(const double *light, const double *finest, double share)
{
    double square = 0, power = 0;

    for (size_t k = 0; k < BIAS_CHECK_VALUES; ++k) {
        square += pow(light[k] - finest[k], 2);
        power += pow(finest[k], 2);
    }
    return sqrt(square / power / (1 + share));
}

// A lamp in the medium is no peak for particles that leave it: noise falls with the root of their number. With walks
// it does not.
static void noise_of_a_lamp_inside_falls_evenly(void **state)
{
    enum { FINEST = 4 };
    struct bias_check_scene scene = {.media = EVEN, .lights = INSIDE, .orders = "\"all\"", .background = "0"};
    double finest[BIAS_CHECK_VALUES], light[BIAS_CHECK_VALUES], first = 0;
    char quality[256];

    (void)state;
    scene.quality = quality;
    for (int i = FINEST; i >= 0; --i) {
        double noise;

        snprintf(quality, sizeof quality, FROM_LIGHTS ", \"scatter_grid\": 16, \"paths\": %d", 1 << 2 * i);
        render_check(&scene, i == FINEST ? finest : light);
        if (i == FINEST) continue;
        noise = noise_beside(light, finest, exp2(2 * (i - FINEST))) * exp2(i);
        print_message("%d paths a node: noise %.4f over their root\n", 1 << 2 * i, noise);
        if (first == 0) first = noise;
        assert_true(noise > 0 && noise < 1.6 * first && noise > first / 1.6);
    }
}

static void assert_refused(const struct bias_check_scene *scene, const char *message)
{
    struct stage stage = open_stage();
    struct error error = {{0}};
    struct job job;

    bias_check_parse(&job, scene);
    assert_false(renderer_render(stage.gl.renderer, &(struct renderer_frame){.job = &job, .image = &stage.image},
                                 &stage.result, &error));
    if (!strstr(error.message, message)) fail_msg("%s", error.message);
    job_finish(&job);
    close_stage(&stage);
}

static void a_grid_takes_no_more_than_512_mebibytes(void **state)
{
    struct bias_check_scene scene = {.media = EVEN, .lights = SUN, .orders = "2"};

    (void)state;
    scene.quality = "\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 48, \"scatter_grid\": 256";
    assert_refused(&scene,
                   "quality.scatter_grid: expected at most about 244 cells here, since a frame's grid takes up to "
                   "512 MiB; 256 need 583");
    scene.quality = FROM_LIGHTS ", \"scatter_grid\": 240";
    assert_refused(&scene, "quality.scatter_grid: expected at most about 235 cells here");
}

// Media's own light is scattered once less than a sky's.
static void emitted_light_scatters_too(void **state)
{
    static const char media[] = "{ \"sigma_s\": 2, \"sigma_a\": 1, \"emission\": 1, " LOBE("0.3");

    (void)state;
    assert_true_to(media, "", "2", 0.01);
    assert_true_to(media, "", "\"all\"", 0.01);
    assert_true_to(media, GRADIENT, "2", 0.01);
}

static void voxels_are_lit_by_all_orders(void **state)
{
    enum { X = 20, Y = 18, Z = 19 };
    const char *path = temp_folder_path(state, "lumps_20x18x19xuint8.raw");
    unsigned char voxels[X * Y * Z];
    char media[1024];

    for (int n = 0; n < X * Y * Z; ++n) {
        double x = n % X, y = n / X % Y, z = n / X / Y;
        double near = hypot(hypot(x - 5, y - 6), z - 6), far = hypot(hypot(x - 14, y - 12), z - 13);

        voxels[n] = (unsigned char)fmax(60 - 12 * near, fmax(200 - 40 * far, 0));
    }
    volume_maker_write(path, voxels, sizeof voxels);
    snprintf(media, sizeof media,
             "{ " COLOURED ", \"density\": { \"kind\": \"grid\", \"file\": \"%s\", \"spacing\": [0.09, 0.09, 0.09],"
             " \"center\": [0, 0, 0], \"scale\": 0.02 } }",
             path);
    assert_true_to(media, SUN, "\"all\"", 0.015);
}

static void every_march_looks_the_grid_up(void **state)
{
    static const char *const qualities[] = {
        "\"method\": \"midpoint\", \"step\": 0.02, \"light_step\": 0.05" GRID,
        "\"method\": \"jittered\", \"step\": 0.02, \"light_step\": 0.05" GRID,
        "\"method\": \"adaptive\", \"step\": 0.02, \"light_step\": 0.05, \"depth_step\": 0.1" GRID,
        "\"method\": \"gauss\", \"step\": 0.1, \"light_step\": 0.1, \"order\": 3" GRID,
        "\"method\": \"equiangular\", \"points\": 24" GRID};
    struct truth truth;

    (void)state;
    find_truth(&truth, EVEN, SUN, "3");
    for (size_t i = 0; i < sizeof qualities / sizeof *qualities; ++i)
        assert_near_truth(&truth, qualities[i], 0.015);
}

// Two media of one lobe each are one medium of both lobes.
static void media_of_other_phases_have_values_of_their_own(void **state)
{
    static const char one[] =
        "{ \"sigma_s\": [2, 1, 3], \"sigma_a\": 0.2, \"phase\": [ { \"g\": 0.7, \"weight\": 0.5 }, { \"g\": -0.3,"
        " \"weight\": 0.5 } ], \"density\": { \"kind\": \"homogeneous\", " BALL " } } }";
    static const char two[] = "{ \"sigma_s\": [1, 0.5, 1.5], \"sigma_a\": 0.2, " LOBE(
        "0.7") ","
               "{ \"sigma_s\": [1, 0.5, 1.5], \"sigma_a\": 0, " LOBE("-0.3");
    struct bias_check_scene scene = {.media = one, .lights = SUN, .orders = "5", .background = "0", .quality = CACHED};
    double light_of_one[BIAS_CHECK_VALUES], light_of_two[BIAS_CHECK_VALUES], square = 0, power = 0;

    (void)state;
    render_check(&scene, light_of_one);
    scene.media = two;
    render_check(&scene, light_of_two);
    for (size_t i = 0; i < BIAS_CHECK_VALUES; ++i) {
        square += pow(light_of_two[i] - light_of_one[i], 2);
        power += pow(light_of_one[i], 2);
    }
    print_message("two media and one: %.4f\n", sqrt(square / power));
    assert_true(square > 0 && sqrt(square / power) < 0.03);
}

static double furnace_error(const char *media, const char *quality)
{
    const struct bias_check_scene scene = {
        .media = media, .lights = SKY, .orders = "\"all\"", .background = "0", .quality = quality};
    struct image image;
    struct job job;
    double square = 0, power = 0;

    bias_check_parse(&job, &scene);
    render_frame_zero(&job, &image);
    for (int k = 0; k < BIAS_CHECK_VALUES; ++k) {
        double covered = 1 - image.transmittance[k / 3 * 4 + k % 3];

        square += pow(image.rgba[k / 3 * 4 + k % 3] - covered, 2);
        power += pow(covered, 2);
    }
    print_message("furnace: %.5f\n", sqrt(square / power));
    assert_true(power > 1);
    image_finish(&image);
    job_finish(&job);
    return sqrt(square / power);
}

// What scatters all of an even sky's light, whatever its shape and phase, looks like the sky: a ray brings what it
// would bring without media. The sky is not seen behind them here.
static void a_white_furnace_is_even(void **state)
{
    static const char noise[] =
        "{ \"sigma_s\": [9, 3, 1], \"sigma_a\": 0, \"density\": { \"kind\": \"noise\", \"frequency\": 2.5,"
        " \"octaves\": 2, \"mode\": \"clip\", \"scale\": 4, " BALL ", \"falloff\": 0.3 } } }";

    (void)state;
    // Weights are 1 without colours, however few walks there are; those that share collisions have noise.
    assert_true(furnace_error("{ \"sigma_s\": 5, \"sigma_a\": 0, " LOBE("0.8"), COARSE) < 1e-4);
    assert_true(furnace_error(noise, CACHED) < 0.022);
}

// Particles have noise in any furnace.
static void a_white_furnace_of_particles_is_even(void **state)
{
    (void)state;
    assert_true(furnace_error("{ \"sigma_s\": 5, \"sigma_a\": 0, " LOBE("0"), LIGHTS) < 0.015);
    assert_true(furnace_error("{ \"sigma_s\": 5, \"sigma_a\": 0, " LOBE("-0.5"), LIGHTS) < 0.03);
    assert_true(furnace_error("{ \"sigma_s\": [9, 3, 1], \"sigma_a\": 0, " LOBE("0.5"), LIGHTS) < 0.03);
}

// A renderer that was busy before runs the walks in other strips. The grid is kept while nothing moves.
static void assert_same_for_all(const char *quality)
{
    struct bias_check_scene scene = {.media = EVEN, .lights = SUN, .orders = "\"all\"", .quality = quality};
    struct stage alone = open_stage(), busy = open_stage();
    size_t size = BIAS_CHECK_VALUES / 3 * 4 * sizeof *alone.image.rgba;
    struct job job, other;

    bias_check_parse(&job, &scene);
    scene.quality = "\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 32, \"scatter_grid\": 9, \"paths\": 3000";
    bias_check_parse(&other, &scene);
    render_on(&alone, &job);
    assert_true(alone.result.cache_fills > 0);
    render_on(&busy, &other);
    render_on(&busy, &other);
    assert_int_equal(busy.result.cache_fills, 0);
    render_on(&busy, &job);
    assert_true(busy.result.cache_fills > 0);
    assert_memory_equal(alone.image.rgba, busy.image.rgba, size);
    job.scene.camera.position.value[0] = 0.5; // walks begin against the camera's rays
    render_on(&busy, &job);
    assert_true(busy.result.cache_fills > 0);
    job_finish(&other);
    job_finish(&job);
    close_stage(&busy);
    close_stage(&alone);
}

static void a_grid_is_the_same_for_all(void **state)
{
    (void)state;
    assert_same_for_all(COARSE);
    assert_same_for_all(COARSE ", \"scatter_from\": \"lights\"");
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_orders_are_those_of_the_reference),
        cmocka_unit_test(domes_are_those_of_the_reference),
        cmocka_unit_test_setup_teardown(images_of_skies_are_those_of_the_reference, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test(particles_from_lights_bring_all_orders),
        cmocka_unit_test(particles_come_from_lamps_of_all_sizes),
        cmocka_unit_test(noise_of_a_lamp_inside_falls_evenly),
        cmocka_unit_test(a_grid_takes_no_more_than_512_mebibytes),
        cmocka_unit_test(a_white_furnace_is_even),
        cmocka_unit_test(a_white_furnace_of_particles_is_even),
        cmocka_unit_test(emitted_light_scatters_too),
        cmocka_unit_test_setup_teardown(voxels_are_lit_by_all_orders, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(every_march_looks_the_grid_up),
        cmocka_unit_test(media_of_other_phases_have_values_of_their_own),
        cmocka_unit_test(a_grid_is_the_same_for_all),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
