// The jittered method: noise in place of the midpoint method's bands, and the true light on average.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/gl_stage.h"
#include "tests/support/render_frame.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 32, HEIGHT_PX = 24, PIXELS = WIDTH_PX * HEIGHT_PX };

#define BALL "\"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1"
// Density falls smoothly from the ball's middle to 0 on its surface.
#define SMOOTH_DENSITY "\"density\": { \"kind\": \"homogeneous\", " BALL ", \"falloff\": 1 } }"
#define SMOOTH "{ \"sigma_s\": 2, \"sigma_a\": 1, " SMOOTH_DENSITY " }"
#define THIN "{ \"sigma_s\": 0.1, \"sigma_a\": 0.1, " SMOOTH_DENSITY " }"
// Grains have a quarter of the ball's radius.
#define GRAINS "\"density\": { \"kind\": \"noise\", \"frequency\": 4, \"octaves\": 1, \"mode\": \"clip\", " BALL " } }"
#define GLOWING_GRAINS "{ \"emission\": 1, \"sigma_a\": 0, \"sigma_s\": 0, " GRAINS " }"
#define DARK_GRAINS "{ \"emission\": 1, \"sigma_a\": 2, \"sigma_s\": 0, " GRAINS " }"
#define LAMP "{ \"kind\": \"point\", \"intensity\": 4, \"position\": [1.5, 1, 1] },"

// A black light that moves is added to `lights`: each frame shows the same light with other random numbers.
static void parse(struct job *job, const char *media, const char *lights, const char *quality)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"jittered\", \"frames\": \"0-999\", \"fps\": 24, \"resolution\": [%d, %d],"
             " \"camera\": { \"position\": [0.1, 0.2, 4], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 32 },"
             " \"lights\": [ %s { \"kind\": \"point\", \"intensity\": 0, \"position\": { \"start\": [0, 9, 0],"
             " \"rate\": [1, 0, 0] } } ], \"scene\": { \"media\": [ %s ] }, \"quality\": { %s },"
             " \"output\": { \"path\": \"jittered.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             WIDTH_PX, HEIGHT_PX, lights, media, quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

// Sums over frames of each pixel's red and its transmittance. Other channels are equal to red.
struct sums {
    double light[PIXELS], squares[PIXELS], transmittance[PIXELS];
    int count;
};

static void add_frames(struct sums *sums, const struct job *job, int count)
{
    struct error error = {{0}};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct image image;

    assert_true(image_init(&image, WIDTH_PX, HEIGHT_PX, true, true, NULL));
    for (int32_t frame = 0; frame < count; ++frame) {
        if (!renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = &image},
                             &result, &error))
            fail_msg("%s", error.message);
        for (int i = 0; i < PIXELS; ++i) {
            sums->light[i] += (double)image.rgba[4 * i];
            sums->squares[i] += pow((double)image.rgba[4 * i], 2);
            sums->transmittance[i] += (double)image.transmittance[4 * i];
        }
    }
    sums->count += count;
    image_finish(&image);
    gl_stage_close(stage);
}

static struct sums measure(const char *media, const char *lights)
{
    static const struct integrate_accuracy accuracy = {.relative = 1e-5};
    struct sums truth = {.count = 1};
    struct still still;
    struct job job;

    parse(&job, media, lights, "\"method\": \"midpoint\", \"step\": 1, \"light_step\": 1");
    still_init(&still, &job, 0);
    for (int i = 0; i < PIXELS; ++i) {
        struct reference_pixel pixel = reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX, &accuracy);

        assert_true(pixel.is_converged);
        truth.light[i] = pixel.radiance[0];
        truth.transmittance[i] = pixel.transmittance[0];
    }
    job_finish(&job);
    return truth;
}

// The true light of the smooth ball, measured once.
static const struct sums *lit_smooth_ball(void)
{
    static struct sums truth;

    if (truth.count == 0) truth = measure(SMOOTH, LAMP);
    return &truth;
}

static struct sums render(const char *media, const char *lights, const char *quality, int count)
{
    struct sums sums = {.count = 0};
    struct job job;

    parse(&job, media, lights, quality);
    add_frames(&sums, &job, count);
    job_finish(&job);
    return sums;
}

#define STEPS(METHOD, STEP, LIGHT_STEP) "\"method\": \"" METHOD "\", \"step\": " STEP ", \"light_step\": " LIGHT_STEP

// Root of the mean square error and mean error, relative to the mean of the truth, and the correlation of the errors of
// horizontally adjacent pixels.
struct errors {
    double rmse, bias, neighbours; // neighbours: from -1 to 1
};

static struct errors find_errors(const double *sums, int count, const double *truth)
{
    static double errors[PIXELS];
    double mean = 0, square = 0, whole = 0, together = 0;

    for (int i = 0; i < PIXELS; ++i) {
        errors[i] = sums[i] / count - truth[i];
        mean += errors[i] / PIXELS;
        square += errors[i] * errors[i] / PIXELS;
        whole += truth[i] / PIXELS;
    }
    for (int i = 0; i < PIXELS; ++i)
        if (i % WIDTH_PX > 0) together += (errors[i] - mean) * (errors[i - 1] - mean) / PIXELS;
    return (struct errors){sqrt(square) / whole, mean / whole, together / (square - mean * mean)};
}

static struct errors light_errors(const struct sums *sums, const struct sums *truth, const char *name)
{
    struct errors light = find_errors(sums->light, sums->count, truth->light);

    print_message("%s, %d frames: RMSE of light %.2e, bias %.2e, correlation of neighbours %.2f\n", name, sums->count,
                  light.rmse, light.bias, light.neighbours);
    return light;
}

static struct errors smooth_errors(const char *quality, int count)
{
    struct sums sums = render(SMOOTH, LAMP, quality, count);

    return light_errors(&sums, lit_smooth_ball(), quality);
}

// The correlation of uncorrelated noise over 24 rows of 31 pairs of pixels has a standard deviation of 0.04.
static void bands_of_coarse_steps_become_noise(void **state)
{
    struct errors wide = smooth_errors(STEPS("midpoint", "1", "1"), 1);
    struct errors narrow = smooth_errors(STEPS("midpoint", "0.5", "0.5"), 1);

    assert_true(wide.neighbours > 0.8 && narrow.neighbours > 0.8);
    wide = smooth_errors(STEPS("jittered", "1", "1"), 1);
    narrow = smooth_errors(STEPS("jittered", "0.5", "0.5"), 1);
    assert_true(fabs(wide.neighbours) < 0.2 && fabs(narrow.neighbours) < 0.2);
}

// Noise of sixteen times as many frames is a quarter.
static void noise_falls_with_the_root_of_samples(void **state)
{
    struct errors one = smooth_errors(STEPS("jittered", "0.125", "0.125"), 1);
    struct errors many = smooth_errors(STEPS("jittered", "0.125", "0.125"), 16);

    assert_true(many.rmse > 0.2 * one.rmse && many.rmse < 0.32 * one.rmse);
}

// Bias at half the step is a quarter, or less.
static void bias_falls_with_the_square_of_the_step(void **state)
{
    // The lamp's light does not fall off: steps would be shorter next to one whose light does.
    static const char lamp[] =
        "{ \"kind\": \"point\", \"falloff\": \"none\", \"intensity\": 1, \"position\": [1.5, 1, 1] },";
    struct sums truth = measure(SMOOTH, lamp);
    struct sums wide = render(SMOOTH, lamp, STEPS("jittered", "0.5", "0.5"), 64);
    struct sums narrow = render(SMOOTH, lamp, STEPS("jittered", "0.125", "0.125"), 64);
    struct errors coarse = light_errors(&wide, &truth, "steps of a half");
    struct errors fine = light_errors(&narrow, &truth, "steps of an eighth");

    assert_true(fabs(fine.bias) < fabs(coarse.bias) / 8);
    assert_true(fabs(fine.bias) < 3e-3);
}

// Media without extinction have no bias, even with steps longer than grains: all error is random.
static void glow_is_unbiased_at_any_step(void **state)
{
    struct sums truth = measure(GLOWING_GRAINS, ""), sums = {.count = 0};
    double squares = 0, count = 0;
    struct job job;

    parse(&job, GLOWING_GRAINS, "", STEPS("jittered", "0.7", "1"));
    add_frames(&sums, &job, 64);
    job_finish(&job);
    for (int i = 0; i < PIXELS; ++i) {
        double mean = sums.light[i] / sums.count, variance = sums.squares[i] / sums.count - mean * mean;

        if (truth.light[i] <= 0.02) continue;
        squares += pow(mean - truth.light[i], 2) / (variance / (sums.count - 1));
        ++count;
    }
    print_message("%g pixels, mean square of the errors in standard errors: %.3f\n", count, squares / count);
    assert_true(count > PIXELS / 4);
    // The standard deviation of this mean is the root of 2 / count. Variances of only 64 frames add some hundredths.
    assert_true(fabs(squares / count - 1) < 0.25);
    sums = render(GLOWING_GRAINS, "", STEPS("midpoint", "0.7", "1"), 1);
    assert_true(find_errors(sums.light, 1, truth.light).rmse > 0.2);
}

// Steps of half a grain's size resolve grains badly. The error of the mean over many frames is less than half of the
// midpoint method's.
static void grains_have_less_error_than_at_midpoints(void **state)
{
    struct sums truth = measure(DARK_GRAINS, "");
    struct sums midpoint = render(DARK_GRAINS, "", STEPS("midpoint", "0.125", "1"), 1);
    struct sums jittered = render(DARK_GRAINS, "", STEPS("jittered", "0.125", "1"), 256);
    struct errors wrong = light_errors(&midpoint, &truth, "midpoint"),
                  left = light_errors(&jittered, &truth, "jittered");

    assert_true(left.rmse < 0.5 * wrong.rmse);
}

// Camera rays take fine steps here, so that the error is that of shadow rays. Their optical depths are so small that
// the mean of the transmittances is the transmittance of the mean depth.
static void marches_to_lights_are_jittered_too(void **state)
{
    struct sums truth = measure(THIN, LAMP);
    struct sums midpoint = render(THIN, LAMP, STEPS("midpoint", "0.02", "1"), 1);
    struct sums jittered = render(THIN, LAMP, STEPS("jittered", "0.02", "1"), 16);
    struct errors wrong = light_errors(&midpoint, &truth, "midpoint"),
                  left = light_errors(&jittered, &truth, "jittered");

    assert_true(left.rmse < 0.25 * wrong.rmse);
}

// Two homogeneous boxes overlap, with a lamp beside them: segments are exact wherever their samples are.
static void homogeneous_media_are_exact(void **state)
{
    static const char boxes[] =
        "{ \"sigma_a\": 2, \"sigma_s\": 1, \"density\": { \"kind\": \"homogeneous\", \"bounds\":"
        " { \"kind\": \"box\", \"center\": [0, 0, 0.1], \"size\": [1, 1, 0.9] } } },"
        "{ \"sigma_a\": 0.5, \"sigma_s\": 0, \"density\": { \"kind\": \"homogeneous\", \"bounds\":"
        " { \"kind\": \"box\", \"center\": [0.3, 0.2, 0], \"size\": [1, 1, 1.3] } } }";
    struct sums truth = measure(boxes, LAMP), sums = render(boxes, LAMP, STEPS("jittered", "0.37", "1"), 1);
    struct errors light = light_errors(&sums, &truth, "even media");

    // Noise comes only from the shadow rays, whose length differs from point to point.
    assert_true(light.rmse > 1e-4);
    assert_true(find_errors(sums.transmittance, 1, truth.transmittance).rmse < 1e-6);
}

// The medium glows where z < -0.9, down to the box's face at -1. Its density there is the number of evaluations so far,
// and in front of it minus the distance to it.
#define COUNTING                                                                                                       \
    "{ \"sigma_a\": 0, \"sigma_s\": 1e-6, \"emission\": 1, \"density\": { \"kind\": \"glsl\", \"lipschitz\": 1,"       \
    " \"source\": \"int count = 0; float density(vec3 p, float t) { ++count; return p.z < -0.9 ? float(count) :"       \
    " -0.9 - p.z; }\", \"bounds\": { \"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [9, 9, 2] } } }"
#define SUN(DIRECTION) "{ \"kind\": \"sun\", \"intensity\": 1, \"direction\": [0, 0, " DIRECTION "] },"

// The glowing part has about ten segments. Steps through the empty part would add 190 evaluations to each.
static void empty_space_is_skipped(void **state)
{
    // The camera looks towards -z through the empty part. The second light comes through it, too.
    struct sums midpoint = render(COUNTING, SUN("1"), STEPS("midpoint", "0.01", "0.01"), 1);
    struct sums jittered = render(COUNTING, SUN("1"), STEPS("jittered", "0.01", "0.01"), 1);
    struct sums midpoint_lit = render(COUNTING, SUN("-1"), STEPS("midpoint", "0.01", "0.01"), 1);
    struct sums jittered_lit = render(COUNTING, SUN("-1"), STEPS("jittered", "0.01", "0.01"), 1);
    int middle = PIXELS / 2 + WIDTH_PX / 2;

    print_message("evaluations along a ray: midpoint %.3g and %.3g, jittered %.3g and %.3g\n", midpoint.light[middle],
                  midpoint_lit.light[middle], jittered.light[middle], jittered_lit.light[middle]);
    assert_true(jittered.light[middle] < 1.5 * midpoint.light[middle]);
    assert_true(jittered_lit.light[middle] < 1.5 * midpoint_lit.light[middle]);
}

// Renders frames `first` to `last` with one renderer. Returns the picture of `last`.
static struct image render_up_to(const struct job *job, int32_t first, int32_t last)
{
    struct error error = {{0}};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct image image;

    assert_true(image_init(&image, job->width_px, job->height_px, true, true, NULL));
    for (int32_t frame = first; frame <= last; ++frame)
        if (!renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = &image},
                             &result, &error))
            fail_msg("%s", error.message);
    gl_stage_close(stage);
    return image;
}

// A picture does not depend on what its renderer rendered before, though that changes the size of tiles. Each frame has
// random numbers of its own.
static void a_frame_is_the_same_picture_for_all(void **state)
{
    struct image alone, after_others, other;
    struct job job;
    size_t count, differing = 0;

    parse(&job, SMOOTH, LAMP, STEPS("jittered", "0.5", "0.5"));
    // The picture has more rows than a renderer's first tile.
    job.height_px = 4 * HEIGHT_PX;
    count = 4 * (size_t)job.width_px * (size_t)job.height_px;
    alone = render_up_to(&job, 5, 5);
    after_others = render_up_to(&job, 3, 5);
    other = render_up_to(&job, 4, 4);
    assert_memory_equal(after_others.rgba, alone.rgba, count * sizeof *alone.rgba);
    for (size_t i = 0; i < count; i += 4)
        differing += other.rgba[i] != alone.rgba[i];
    assert_true(differing > PIXELS / 4);
    image_finish(&alone);
    image_finish(&after_others);
    image_finish(&other);
    job_finish(&job);
}

// Random numbers are integers until they are divided, so that both drivers draw the same ones. Other arithmetic differs
// by roundings.
static void both_backends_draw_the_same_numbers(void **state)
{
    struct image first, second;
    struct job job;

    parse(&job, SMOOTH, LAMP, STEPS("jittered", "0.5", "0.5"));
    render_frame_on(GL_BACKEND_EGL, &job, &first);
    render_frame_on(GL_BACKEND_SOFTWARE, &job, &second);
    job_finish(&job);
    for (int i = 0; i < 4 * PIXELS; ++i)
        assert_near(first.rgba[i], second.rgba[i], 1e-5 * fmax(1, second.rgba[i]));
    image_finish(&first);
    image_finish(&second);
}

// Media end at objects and fill them. Refracted rays and shadow rays take random steps as camera rays do.
static void media_among_objects_are_jittered(void **state)
{
    static const char scene[] = THIN
        "], \"objects\": ["
        "{ \"kind\": \"plane\", \"point\": [0, -0.7, 0], \"material\": { \"kind\": \"diffuse\", \"albedo\": 0.7 } },"
        "{ \"kind\": \"sphere\", \"center\": [0.3, -0.1, 0.4], \"radius\": 0.5, \"material\": { \"kind\":"
        " \"dielectric\", \"ior\": 1.5, \"interior\": { \"sigma_s\": 0.3, \"sigma_a\": 0.2, \"density\": { \"kind\":"
        " \"homogeneous\", \"bounds\": { \"kind\": \"sphere\", \"center\": [0.3, 0, 0.3], \"radius\": 0.5,"
        " \"falloff\": 0.4 } } } } }";
    struct sums truth = measure(scene, LAMP);
    struct sums four = render(scene, LAMP, STEPS("jittered", "0.2", "0.2"), 4);
    struct sums many = render(scene, LAMP, STEPS("jittered", "0.2", "0.2"), 64);
    struct errors few = light_errors(&four, &truth, "among objects"),
                  left = light_errors(&many, &truth, "among objects");

    assert_true(left.rmse > 0.2 * few.rmse && left.rmse < 0.4 * few.rmse);
    assert_true(fabs(left.bias) < 1e-3);
}

// Roulette ends rays at random, and leaves the mean. A least transmittance ends rays early, and loses light.
static void rays_still_end_early(void **state)
{
    struct errors whole = smooth_errors(STEPS("jittered", "0.1", "0.1"), 64);
    struct errors roulette =
        smooth_errors(STEPS("jittered", "0.1", "0.1") ", \"roulette\": { \"below\": 0.8, \"survive\": 0.3 }", 64);
    struct errors early = smooth_errors(STEPS("jittered", "0.1", "0.1") ", \"min_transmittance\": 0.8", 64);

    assert_true(roulette.rmse > 1.2 * whole.rmse);
    // The tolerance is four standard errors of the mean over all pixels and frames.
    assert_near(roulette.bias, whole.bias, 4 * roulette.rmse / sqrt(PIXELS));
    assert_true(early.bias < whole.bias - 0.05);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bands_of_coarse_steps_become_noise),
        cmocka_unit_test(noise_falls_with_the_root_of_samples),
        cmocka_unit_test(bias_falls_with_the_square_of_the_step),
        cmocka_unit_test(glow_is_unbiased_at_any_step),
        cmocka_unit_test(grains_have_less_error_than_at_midpoints),
        cmocka_unit_test(marches_to_lights_are_jittered_too),
        cmocka_unit_test(homogeneous_media_are_exact),
        cmocka_unit_test(empty_space_is_skipped),
        cmocka_unit_test(a_frame_is_the_same_picture_for_all),
        cmocka_unit_test(both_backends_draw_the_same_numbers),
        cmocka_unit_test(media_among_objects_are_jittered),
        cmocka_unit_test(rays_still_end_early),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
