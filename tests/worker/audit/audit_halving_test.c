// Audits by step halving, compared with twins in C of densities in GLSL.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/render_frame.h"
#include "worker/audit/audit.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 24, HEIGHT_PX = 14, PIXELS = WIDTH_PX * HEIGHT_PX };

// Moving lumps, smooth everywhere.
static const char LUMPS[] = "float density(vec3 p, float t) { "
                            "return 6.0 * exp(-6.0 * dot(p, p)) * (1.0 + 0.6 * sin(5.0 * p.x + t) * cos(4.0 * p.y)); }";

static double lumps_at(const void *context, struct vec3 p, double t)
{
    return 6.0 * exp(-6.0 * vec3_dot(p, p)) * (1.0 + 0.6 * sin(5.0 * p.x + t) * cos(4.0 * p.y));
}

// A shell with kinks at its faces and in its middle.
static const char SHELL[] = "float density(vec3 p, float t) { return 20.0 * (0.12 - abs(length(p) - 0.7)); }";

static double shell_at(const void *context, struct vec3 p, double t)
{
    return 20.0 * (0.12 - fabs(vec3_length(p) - 0.7));
}

static void parse(struct job *job, const char *source, const char *quality)
{
    struct error error = {{0}};
    char text[2048];

    snprintf(text, sizeof text,
             "{\"version\": 1, \"name\": \"code\", \"frames\": \"0-9\", \"fps\": 1, \"resolution\": [%d, %d],"
             " \"camera\": {\"position\": [0, 0.4, 3.2], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 40, "
             "\"clip\": [1, 6]},"
             " \"lights\": [{\"kind\": \"point\", \"intensity\": 8, \"position\": [1.5, 1.2, 0.8]}],"
             " \"scene\": {\"media\": [{\"density\": {\"kind\": \"glsl\", \"source\": \"%s\", \"bounds\": {\"kind\": "
             "\"sphere\", \"radius\": 1, \"falloff\": 0.1}}, \"sigma_s\": [1, 0.8, 0.6], \"sigma_a\": 0.2}]},"
             " \"quality\": %s, \"output\": {\"path\": \"code.####.exr\"}}",
             WIDTH_PX, HEIGHT_PX, source, quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static void measure_light(const struct job *job, density_function_at *at, struct truth_pixel *light)
{
    const struct still_function functions[SCENE_MEDIUM_LIMIT] = {{.at = at}};
    const struct integrate_accuracy accuracy = {.relative = 3e-3};
    struct pixel points[PIXELS];
    struct error error = {{0}};
    struct truth *truth;

    for (int i = 0; i < PIXELS; i++)
        points[i] = (struct pixel){i % WIDTH_PX, i / WIDTH_PX};
    truth = truth_open(&(struct truth_params){.job = job, .functions = functions}, &error);
    if (!truth) fail_msg("%s", error.message);
    truth_measure_many(truth,
                       &(struct truth_many){.points = points, .pixels = light, .count = PIXELS, .accuracy = &accuracy});
    truth_close(truth);
}

static double find_error(const struct image *image, const struct truth_pixel *light)
{
    double errors = 0.0, squares = 0.0;

    for (int i = 0; i < PIXELS; i++) {
        for (int c = 0; c < 3; c++) {
            double difference = image->rgba[4 * i + c] - light[i].rgb[c];

            errors += difference * difference;
            squares += light[i].rgb[c] * light[i].rgb[c];
        }
    }
    return sqrt(errors / squares);
}

// An even quarter of the frame's pixels.
static struct image pick(const struct image *frame)
{
    struct image picked;

    assert_true(image_init(&picked, WIDTH_PX / 2, HEIGHT_PX / 2, false, false, NULL));
    for (int i = 0; i < PIXELS / 4; i++) {
        int x = 2 * (i % (WIDTH_PX / 2)) + 1, y = 2 * (i / (WIDTH_PX / 2)) + 1;

        memcpy(&picked.rgba[4 * i], &frame->rgba[4 * (y * WIDTH_PX + x)], 4 * sizeof(float));
    }
    return picked;
}

// Renders the frame, and some of its pixels in finer steps, as a farm would.
static void check_steps(const struct job *job, double factor, const struct truth_pixel *light)
{
    struct job used = *job, halved;
    struct image image, finer, image_seen, finer_seen;
    struct audit_result result;
    double error;

    used.quality.step *= factor;
    used.quality.light_step *= factor;
    used.quality.light_steps = (int)(used.quality.light_steps / factor);
    halved = used;
    halved.quality.step *= 0.5;
    halved.quality.light_step *= 0.5;
    halved.quality.light_steps *= 2;
    render_frame_zero(&used, &image);
    render_frame_zero(&halved, &finer);
    image_seen = pick(&image);
    finer_seen = pick(&finer);
    audit_by_halving(&used, &image_seen, &finer_seen, &result);
    error = find_error(&image, light);
    print_message("%s, step %g: error %.2e, estimated %.2e, at most %.2e\n", job_method_name(used.quality.method),
                  used.quality.step, error, result.error, result.error95);
    assert_int_equal(result.kind, AUDIT_STEP_HALVING);
    assert_true(error <= result.error95);
    assert_true(result.error95 <= 8.0 * error);
    image_finish(&image);
    image_finish(&finer);
    image_finish(&image_seen);
    image_finish(&finer_seen);
}

// `qualities` end with NULL; the true light is the same for all.
static void check_code(const char *source, density_function_at *at, const char *const *qualities)
{
    struct truth_pixel *light = calloc(PIXELS, sizeof *light);
    struct job job;

    for (size_t i = 0; qualities[i]; i++) {
        parse(&job, source, qualities[i]);
        if (i == 0) measure_light(&job, at, light);
        for (double factor = 1.0; factor <= 8.0; factor *= 2.0)
            check_steps(&job, factor, light);
        job_finish(&job);
    }
    free(light);
}

static const char MIDPOINT[] = "{\"method\": \"midpoint\", \"step\": 0.03, \"light_step\": 0.04}";
static const char RIEMANN[] = "{\"method\": \"riemann\", \"step\": 0.03, \"light_steps\": 64}";
static const char JITTERED[] = "{\"method\": \"jittered\", \"step\": 0.03, \"light_step\": 0.04}";

static void smooth_code_is_known_to_its_bound(void **state)
{
    check_code(LUMPS, lumps_at, (const char *const[]){MIDPOINT, RIEMANN, JITTERED, NULL});
}

static void code_with_kinks_is_known_to_its_bound(void **state)
{
    check_code(SHELL, shell_at, (const char *const[]){MIDPOINT, RIEMANN, NULL});
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smooth_code_is_known_to_its_bound),
        cmocka_unit_test(code_with_kinks_is_known_to_its_bound),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
