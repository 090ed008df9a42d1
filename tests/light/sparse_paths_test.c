// Random paths of a part of the pixels: two layers add up to all of the light, and interpolation saves paths.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_layers.h"
#include "tests/support/bias_check.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "tests/support/sparse_pair.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/picture/pixel.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define BOUNDS "\"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9"
#define EVEN                                                                                                           \
    "{ \"sigma_s\": [2, 1, 3], \"sigma_a\": [0.2, 1, 0.5], \"density\": { \"kind\": \"homogeneous\", " BOUNDS " } } }"
#define NOISE                                                                                                          \
    "{ \"sigma_s\": [2, 1, 3], \"sigma_a\": [0.2, 1, 0.5], \"emission\": [0.2, 0.4, 0.6], \"phase\": [ { \"g\": 0.4,"  \
    " \"weight\": 1 } ], \"density\": { \"kind\": \"noise\", \"frequency\": 2.5, \"octaves\": 2, \"H\": 0.6,"          \
    " \"lacunarity\": 2, \"bias\": 0.2, \"mode\": \"clip\", \"scale\": 4, " BOUNDS ", \"falloff\": 0.3 } } }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": [3, 2, 1], \"direction\": [-1, -2, 0.5] },"
#define LAMP "{ \"kind\": \"point\", \"intensity\": [1, 3, 2], \"position\": [1.2, 1, 0.9] },"
#define SKY "{ \"kind\": \"dome\", \"radiance\": [0.3, 0.5, 0.9], \"visible\": true },"
#define FLOOR                                                                                                          \
    "{ \"kind\": \"plane\", \"point\": [0, -0.6, 0],"                                                                  \
    " \"material\": { \"kind\": \"diffuse\", \"albedo\": [0.7, 0.6, 0.5] } }"
#define SPARSE(COUNT, STRIDE)                                                                                          \
    "\"method\": \"paths\", \"paths\": " COUNT ", \"step\": 0.01, \"pixels\": { \"stride\": " STRIDE                   \
    ", \"threshold\": 0.02 }"

static void assert_layers_add_up(struct bias_check_scene scene)
{
    static double truth[BIAS_CHECK_VALUES], noise[BIAS_CHECK_VALUES];
    struct bias_check_errors errors;

    scene.quality = SPARSE("32", "8");
    scene.orders = "\"all\"";
    scene.noise = noise;
    bias_check_find_paths(&scene, 2048, truth, noise);
    errors = bias_check_measure(&scene, truth, 96);
    assert_true(fabs(errors.sigmas) < 3.5);
    assert_true(errors.chance > 0.1 && errors.chance < 3);
    assert_true(errors.spread > 1e-3);
}

static void layers_add_up_to_all_light(void **state)
{
    (void)state;
    assert_layers_add_up((struct bias_check_scene){.media = EVEN ", " NOISE, .lights = SUN LAMP});
    assert_layers_add_up((struct bias_check_scene){.media = NOISE, .lights = SKY, .background = ""});
    assert_layers_add_up((struct bias_check_scene){.media = NOISE, .lights = LAMP, .objects = FLOOR});
    // A dome lights the floor along paths alone: a march has it behind everything.
    assert_layers_add_up((struct bias_check_scene){.media = NOISE, .lights = SKY, .background = "", .objects = FLOOR});
}

static void parse(struct job *job, const char *media, const char *lights, const char *quality, int width, int height)
{
    bias_check_parse(
        job, &(struct bias_check_scene){.media = media, .lights = lights, .quality = quality, .orders = "\"all\""});
    job->width_px = width;
    job->height_px = height;
}

// Alpha, depth and transmittance are the march's, to the bit.
static void assert_seen_is_marched(const char *media, const char *quality)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct image both, marched;
    struct job job, seen;

    parse(&job, media, SUN, quality, 48, 36);
    seen = job_layers_seen(&job);
    both = sparse_pair_frame(stage.renderer, &job, 0, job.quality.pixels, &result);
    marched = sparse_pair_frame(stage.renderer, &seen, 0, job.quality.pixels, &result);
    assert_true((both.doubts != NULL) == (job.quality.pixels.stride > 0));
    for (size_t i = 0; i < 48 * 36; i++) {
        assert_true(both.rgba[4 * i + 3] == marched.rgba[4 * i + 3]);
        assert_memory_equal(both.transmittance + 4 * i, marched.transmittance + 4 * i, 3 * sizeof(float));
        assert_true(both.depth[i] == marched.depth[i]);
        // Light is added to what is seen.
        for (size_t c = 0; c < 3; c++)
            assert_true(both.rgba[4 * i + c] >= marched.rgba[4 * i + c]);
    }
    image_finish(&both);
    image_finish(&marched);
    gl_stage_close(stage);
    job_finish(&job);
}

static void what_is_seen_has_no_noise(void **state)
{
    (void)state;
    assert_seen_is_marched(EVEN ", " NOISE, SPARSE("2", "8"));
    assert_seen_is_marched(EVEN ", " NOISE, "\"method\": \"paths\", \"paths\": 2, \"step\": 0.01");
    assert_seen_is_marched(EVEN, "\"method\": \"paths\", \"paths\": 2");
}

// Half the difference between the means of two halves of the paths has the variance of the mean of all.
static void halves_tell_the_noise(void **state)
{
    enum { FRAMES = 64 };
    static double first[BIAS_CHECK_VALUES], second[BIAS_CHECK_VALUES];
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct pixel pixels[BIAS_CHECK_VALUES / 3];
    struct renderer_result result;
    double told = 0, variance = 0;
    struct error error = {{0}};
    struct image image;
    struct job job, scattered;

    (void)state;
    parse(&job, EVEN, SUN, SPARSE("32", "8"), BIAS_CHECK_WIDTH_PX, BIAS_CHECK_HEIGHT_PX);
    scattered = job_layers_scattered(&job);
    for (int i = 0; i < BIAS_CHECK_VALUES / 3; i++)
        pixels[i] = (struct pixel){i % BIAS_CHECK_WIDTH_PX, i / BIAS_CHECK_WIDTH_PX};
    assert_true(image_init(&image, BIAS_CHECK_WIDTH_PX, BIAS_CHECK_HEIGHT_PX, true, true, NULL));
    for (int32_t frame = 0; frame < FRAMES; frame++) {
        // A list of the layer itself: its lattice is left out, what it is given is not.
        struct image layer = {0};
        struct job lone = scattered;

        assert_true(image_init(&layer, BIAS_CHECK_WIDTH_PX, BIAS_CHECK_HEIGHT_PX, false, true, NULL));
        if (!renderer_render_layer(stage.renderer,
                                   &(struct renderer_frame){.job = &lone,
                                                            .frame = frame,
                                                            .pixels = pixels,
                                                            .pixel_count = BIAS_CHECK_VALUES / 3,
                                                            .image = &layer},
                                   &result, &error))
            fail_msg("%s", error.message);
        for (size_t i = 0; i < BIAS_CHECK_VALUES; i++) {
            double value = (double)layer.rgba[i / 3 * 4 + i % 3], half = (double)layer.transmittance[i / 3 * 4 + i % 3];

            first[i] += value / FRAMES;
            second[i] += value * value / FRAMES;
            told += half * half / FRAMES;
        }
        image_finish(&layer);
    }
    for (size_t i = 0; i < BIAS_CHECK_VALUES; i++)
        variance += (second[i] - first[i] * first[i]) * FRAMES / (FRAMES - 1);
    print_message("noise: %.3e told, %.3e found\n", sqrt(told), sqrt(variance));
    assert_true(told > 0.8 * variance && told < 1.25 * variance);
    image_finish(&image);
    gl_stage_close(stage);
    job_finish(&job);
}

enum { WIDE = 192, HIGH = 144, POINTS = 96 };

// The relative RMSE of a frame, by two independent halves of the truth.
static double find_error(const struct image *image, const struct pixel *points, const struct truth_pixel *truth)
{
    double off = 0, light = 0;

    for (size_t i = 0; i < 3 * (size_t)POINTS; i++) {
        const struct pixel *point = &points[i / 3];
        double value = (double)image->rgba[4 * ((size_t)point->y * WIDE + (size_t)point->x) + i % 3];
        double rgb = truth[i / 3].rgb[i % 3], half = truth[i / 3].half[i % 3];

        off += (value - rgb) * (value - rgb) - half * half;
        light += rgb * rgb - half * half;
    }
    return sqrt(fmax(off, 0) / light);
}

static double render_error(struct renderer *renderer, const struct job *job, const struct pixel *points,
                           const struct truth_pixel *truth, double *traced)
{
    struct renderer_result result;
    struct image image = sparse_pair_frame(renderer, job, 0, job->quality.pixels, &result);
    double error = find_error(&image, points, truth);

    *traced = result.traced;
    print_message("%d paths, every %d px: %.1f %% traced, error %.2e\n", job->quality.paths, job->quality.pixels.stride,
                  100 * result.traced, error);
    image_finish(&image);
    return error;
}

// As many paths in all, in fewer pixels.
static void few_pixels_have_less_noise(void **state)
{
    static const struct integrate_accuracy accuracy = {.relative = 0.01, .floor = 0.02};
    static struct truth_pixel truth[POINTS];
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct error error = {{0}};
    struct pixel points[POINTS];
    double traced, all, few, whole;
    struct truth *exact;
    struct job job;

    (void)state;
    // Odd places and even ones, on the lattice and off it.
    for (int i = 0; i < POINTS; i++)
        points[i] = (struct pixel){7 + 15 * (i % 12) + i / 12 % 2, 5 + 17 * (i / 12)};
    parse(&job, EVEN, SUN, SPARSE("1024", "8"), WIDE, HIGH);
    exact = truth_open(&(struct truth_params){.job = &job}, &error);
    if (!exact) fail_msg("%s", error.message);
    truth_measure_many(exact,
                       &(struct truth_many){.points = points, .pixels = truth, .count = POINTS, .accuracy = &accuracy});
    truth_close(exact);
    few = render_error(stage.renderer, &job, points, truth, &traced);
    assert_true(few < 0.04 && traced < 0.3);
    job.quality.pixels = (struct job_pixels){0};
    job.quality.paths = (int)(job.quality.paths * traced);
    all = render_error(stage.renderer, &job, points, truth, &whole);
    assert_true(all > 1.5 * few);
    gl_stage_close(stage);
    job_finish(&job);
}

// Frames with random numbers of their own differ by the noise of both. Interpolated pixels have less than is told.
static void frames_tell_their_noise(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct image one, other;
    double apart = 0, light = 0, noise;
    struct job job;

    (void)state;
    parse(&job, EVEN, SUN, SPARSE("64", "4"), WIDE, HIGH);
    one = sparse_pair_frame(stage.renderer, &job, 0, job.quality.pixels, &result);
    other = sparse_pair_frame(stage.renderer, &job, 1, job.quality.pixels, &result);
    for (size_t i = 0; i < (size_t)4 * WIDE * HIGH; i++) {
        if (i % 4 == 3) continue;
        apart += pow((double)one.rgba[i] - other.rgba[i], 2) / 2;
        light += (double)other.rgba[i] * other.rgba[i];
    }
    noise = sqrt(apart / light);
    print_message("noise: %.3e told, %.3e found, %.1f %% traced\n", result.noise, noise, 100 * result.traced);
    assert_true(noise > 0.55 * result.noise && noise < 1.1 * result.noise);
    image_finish(&one);
    image_finish(&other);
    gl_stage_close(stage);
    job_finish(&job);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_add_up_to_all_light), cmocka_unit_test(what_is_seen_has_no_noise),
        cmocka_unit_test(halves_tell_the_noise),      cmocka_unit_test(few_pixels_have_less_noise),
        cmocka_unit_test(frames_tell_their_noise),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
