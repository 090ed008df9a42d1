// Russian roulette of the midpoint method: the same light on average, with fewer steps.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/ball_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/render_frame.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/shader/scene_program.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { CHANNELS = 4 };

#define SUN "\"lights\": [{\"kind\": \"sun\", \"intensity\": [3, 2, 1], \"direction\": [1, -1, -1]}]"
#define MEDIUM "\"sigma_s\": [1, 2, 3], \"sigma_a\": 1, \"emission\": 0.5"

// The ball is in front of a uniform background, with `samples` samples a pixel.
static void parse(struct job *job, const char *roulette, int samples)
{
    char rest[512];

    snprintf(rest, sizeof rest,
             "\"background\": [0.2, 0.5, 1], " SUN
             ", \"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.1, \"samples\": %d%s}",
             samples, roulette);
    ball_job_parse(job, MEDIUM, rest);
}

struct difference {
    double mean, standard_error; // of the mean
    int differing;               // pixels
};

static struct difference find_difference(const float *values, const float *wanted, size_t pixel_count, size_t channel)
{
    struct difference difference = {0};
    double sum = 0.0, squares = 0.0, count = (double)pixel_count;

    for (size_t i = 0; i < pixel_count; i++) {
        double value = (double)values[CHANNELS * i + channel] - (double)wanted[CHANNELS * i + channel];

        sum += value;
        squares += value * value;
        difference.differing += value != 0.0;
    }
    difference.mean = sum / count;
    difference.standard_error = sqrt((squares / count - difference.mean * difference.mean) / count);
    return difference;
}

// Four standard errors are exceeded by chance once in 16,000 times. Seeds are fixed.
static void assert_same_mean(const float *values, const float *wanted, size_t pixel_count)
{
    for (size_t channel = 0; channel < 3; channel++) {
        struct difference difference = find_difference(values, wanted, pixel_count, channel);

        print_message("channel %zu: mean differs by %.1e, standard error %.1e, %d pixels differ\n", channel,
                      difference.mean, difference.standard_error, difference.differing);
        assert_true(fabs(difference.mean) <= 4.0 * difference.standard_error);
        assert_true(difference.differing > 100);
    }
}

static void assert_unbiased(const char *roulette)
{
    struct image with, without;
    struct job job;

    parse(&job, "", 16);
    render_frame_zero(&job, &without);
    job_finish(&job);
    parse(&job, roulette, 16);
    render_frame_zero(&job, &with);
    assert_same_mean(with.rgba, without.rgba, (size_t)job.width_px * (size_t)job.height_px);
    assert_same_mean(with.transmittance, without.transmittance, (size_t)job.width_px * (size_t)job.height_px);
    job_finish(&job);
    image_finish(&with);
    image_finish(&without);
}

static void mean_is_that_without_roulette(void **state)
{
    assert_unbiased(", \"roulette\": {\"below\": 0.3, \"survive\": 0.5}");
}

static void mean_holds_for_rare_survival_from_the_start(void **state)
{
    assert_unbiased(", \"roulette\": {\"below\": 1, \"survive\": 0.05}");
}

// Weights of surviving rays must not lift a pixel's transmittance above 1.
static void transmittance_stays_within_one(void **state)
{
    struct image image;
    struct job job;

    parse(&job, ", \"roulette\": {\"below\": 1, \"survive\": 0.01}", 1);
    render_frame_zero(&job, &image);
    for (size_t i = 0; i < CHANNELS * (size_t)job.width_px * (size_t)job.height_px; i++)
        assert_true(image.transmittance[i] >= 0.0f && image.transmittance[i] <= 1.0f);
    job_finish(&job);
    image_finish(&image);
}

static void the_same_frame_is_the_same_picture(void **state)
{
    struct image first, second;
    struct job job;

    parse(&job, ", \"roulette\": {\"below\": 0.5, \"survive\": 0.5}", 1);
    render_frame_zero(&job, &first);
    render_frame_zero(&job, &second);
    assert_memory_equal(first.rgba, second.rgba,
                        CHANNELS * sizeof *first.rgba * (size_t)job.width_px * (size_t)job.height_px);
    job_finish(&job);
    image_finish(&first);
    image_finish(&second);
}

// Transmittance through the ball is above 1e-12 along every ray.
static void rays_above_the_limit_are_left_alone(void **state)
{
    struct image with, without;
    struct job job;

    parse(&job, "", 1);
    render_frame_zero(&job, &without);
    job_finish(&job);
    parse(&job, ", \"roulette\": {\"below\": 1e-12, \"survive\": 0.5}", 1);
    render_frame_zero(&job, &with);
    for (size_t i = 0; i < CHANNELS * (size_t)job.width_px * (size_t)job.height_px; i++)
        assert_true(fabsf(with.rgba[i] - without.rgba[i]) <= 1e-6f * fmaxf(1.0f, without.rgba[i]));
    job_finish(&job);
    image_finish(&with);
    image_finish(&without);
}

static bool count_call(void *user, double done)
{
    (void)done;
    ++*(int *)user;
    return true;
}

// Returns how often the renderer reports progress over 200,000 steps through the ball. The driver runs 60,000 at once,
// after which transmittance is still 1e-13.
static int count_slices(const char *roulette, struct error *error)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct image image;
    struct job job;
    char rest[512];
    int calls = 0;

    snprintf(rest, sizeof rest,
             "\"lights\": [], \"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.1%s}",
             roulette);
    ball_job_parse(&job, "\"sigma_s\": 0, \"sigma_a\": 50, \"emission\": 1", rest);
    job.width_px = job.height_px = 1;
    job.quality.step = 1e-5; // set here: the check of a job refuses so many steps
    assert_true(image_init(&image, job.width_px, job.height_px, true, true, error));
    if (!renderer_render(stage.renderer,
                         &(struct renderer_frame){
                             .job = &job, .frame = 0, .image = &image, .on_progress = count_call, .user = &calls},
                         &result, error))
        fail_msg("%s", error->message);
    gl_stage_close(stage);
    image_finish(&image);
    job_finish(&job);
    return calls;
}

static void rays_end_earlier(void **state)
{
    struct error error = {{0}};

    assert_true(count_slices("", &error) >
                count_slices(", \"roulette\": {\"below\": 0.01, \"survive\": 0.5}", &error) + 2);
}

static void without_roulette_its_code_is_absent(void **state)
{
    struct scene_program program;
    struct job job;

    parse(&job, "", 1);
    assert_true(scene_program_init(&program, &job, NULL, NULL, NULL));
    assert_null(strstr(program.fragment, "roulette"));
    assert_null(strstr(program.fragment, "random"));
    scene_program_finish(&program);
    job_finish(&job);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mean_is_that_without_roulette),
        cmocka_unit_test(mean_holds_for_rare_survival_from_the_start),
        cmocka_unit_test(transmittance_stays_within_one),
        cmocka_unit_test(the_same_frame_is_the_same_picture),
        cmocka_unit_test(rays_above_the_limit_are_left_alone),
        cmocka_unit_test(rays_end_earlier),
        cmocka_unit_test(without_roulette_its_code_is_absent),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
