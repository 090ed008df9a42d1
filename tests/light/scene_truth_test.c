// Scenes of every kind, rendered with fine steps, against the converged integral.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "reference/reference.h"
#include "tests/support/example_job.h"
#include "tests/support/render_frame.h"
#include "worker/picture/image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 24, HEIGHT_PX = 16, PIXELS = WIDTH_PX * HEIGHT_PX };

// A camera at an angle, 1.6 m from a small fractal whose folds turn.
#define CAMERA                                                                                                         \
    "\"camera\": { \"position\": [0.9, 0.4, -1.3], \"target\": [0.05, 0, 0], \"up\": [0.1, 1, 0], \"fov\": 40 }"
#define FRACTAL(MORE)                                                                                                  \
    "{ \"density\": { \"kind\": \"fold_fractal\", \"iterations\": 3, \"offset\": 0.05, \"radius\": 0.3,"               \
    " \"rotate_x_rad\": { \"start\": 0.3, \"rate\": 0.2 }, \"rotate_y_rad\": 0.7, \"exponent\": 1.3, \"scale\": 10 "   \
    "}," MORE " }"

static void parse(struct job *job, const char *scene)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"scene\", \"frames\": \"0\", \"fps\": 24, \"time_offset\": 1.5,"
             " \"resolution\": [%d, %d], " CAMERA ", %s,"
             " \"quality\": { \"method\": \"midpoint\", \"step\": 0.01, \"light_step\": 0.01 },"
             " \"output\": { \"path\": \"scene.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             WIDTH_PX, HEIGHT_PX, scene);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static void assert_true_light(const char *scene)
{
    static float radiance[3 * PIXELS], transmittance[3 * PIXELS], alpha[PIXELS];
    static double true_radiance[3 * PIXELS], true_transmittance[3 * PIXELS], true_alpha[PIXELS];
    struct reference_error of_radiance, of_transmittance, of_alpha;
    struct still still;
    struct image image;
    struct job job;

    parse(&job, scene);
    render_frame_zero(&job, &image);
    still_init(&still, &job, job_frame_time(&job, 0));
    for (int i = 0; i < PIXELS; i++) {
        struct reference_pixel pixel = reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX, NULL);

        for (int c = 0; c < 3; c++) {
            radiance[3 * i + c] = image.rgba[4 * i + c];
            transmittance[3 * i + c] = image.transmittance[4 * i + c];
            true_radiance[3 * i + c] = pixel.radiance[c];
            true_transmittance[3 * i + c] = pixel.transmittance[c];
        }
        alpha[i] = image.rgba[4 * i + 3];
        true_alpha[i] = pixel.alpha;
    }
    of_radiance = reference_image_error(radiance, true_radiance, 3 * PIXELS);
    of_transmittance = reference_image_error(transmittance, true_transmittance, 3 * PIXELS);
    of_alpha = reference_image_error(alpha, true_alpha, PIXELS);
    print_message("relative RMSE of radiance %.2e, transmittance %.2e, alpha %.2e\n", of_radiance.relative_rmse,
                  of_transmittance.relative_rmse, of_alpha.relative_rmse);
    // The method is of second order in steps of a thirtieth of the radius; a wrong convention is off by far more.
    assert_true(of_radiance.relative_rmse <= 5e-4);
    assert_true(of_transmittance.relative_rmse <= 5e-4);
    assert_true(of_alpha.relative_rmse <= 5e-4);
    image_finish(&image);
    job_finish(&job);
}

static void colored_media_under_two_kinds_of_light(void **state)
{
    assert_true_light(
        "\"lights\": [ { \"kind\": \"point\", \"falloff\": \"inverse_square\", \"intensity\": [3, 2, 1],"
        " \"position\": [0.8, 0.9, 0.2] },"
        " { \"kind\": \"sun\", \"intensity\": [0.5, 1, 2], \"direction\": [1, -2, 0.5] } ],"
        " \"scene\": { \"media\": [ " FRACTAL(
            "\"sigma_s\": [2, 4, 8], \"sigma_a\": [4, 2, 0], \"phase\": [ { \"g\": 0.7, \"weight\": 0.4 },"
            " { \"g\": -0.5, \"weight\": 0.6 } ]") " ] }");
}

static void media_that_overlap(void **state)
{
    assert_true_light(
        "\"lights\": [ { \"kind\": \"sun\", \"intensity\": 3, \"direction\": [0.3, -1, 0.9] } ],"
        " \"scene\": { \"media\": [ " FRACTAL(
            "\"sigma_s\": 6, \"sigma_a\": [0, 1, 2]") ","
                                                      " { \"density\": { \"kind\": \"fold_fractal\", \"iterations\": "
                                                      "1, \"offset\": 0.1, \"radius\": 0.25,"
                                                      " \"rotate_x_rad\": 0, \"rotate_y_rad\": 0, \"exponent\": 1, "
                                                      "\"scale\": 20 },"
                                                      " \"sigma_s\": [1, 0, 3], \"sigma_a\": 1, \"emission\": [0.1, "
                                                      "0.2, 0.05],"
                                                      " \"phase\": [ { \"g\": 0.6, \"weight\": 1 } ] } ] }");
}

static void light_inside_a_medium(void **state)
{
    assert_true_light("\"lights\": [ { \"kind\": \"point\", \"falloff\": \"none\", \"intensity\": 2,"
                      " \"position\": [0.02, -0.03, 0.05] } ],"
                      " \"scene\": { \"media\": [ " FRACTAL("\"sigma_s\": 3, \"sigma_a\": 0") " ] }");
}

static void glow_before_a_background(void **state)
{
    assert_true_light("\"lights\": [], \"background\": [0.3, 0.2, 0.9],"
                      " \"scene\": { \"media\": [ " FRACTAL(
                          "\"sigma_s\": 0, \"sigma_a\": [3, 6, 9], \"emission\": [2, 1, 0.5]") " ] }");
}

// The background alone has a colour, and yet light is followed as three numbers.
static void grey_before_a_coloured_background(void **state)
{
    assert_true_light("\"lights\": [ { \"kind\": \"sun\", \"intensity\": 3, \"direction\": [0.3, -1, 0.9] } ],"
                      " \"background\": [0.3, 0.2, 0.9],"
                      " \"scene\": { \"media\": [ " FRACTAL("\"sigma_s\": 3, \"sigma_a\": 2") " ] }");
}

static void glow_that_absorbs_nothing(void **state)
{
    assert_true_light(
        "\"lights\": [],"
        " \"scene\": { \"media\": [ " FRACTAL("\"sigma_s\": 0, \"sigma_a\": 0, \"emission\": [2, 1, 0.5]") " ] }");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colored_media_under_two_kinds_of_light),
        cmocka_unit_test(media_that_overlap),
        cmocka_unit_test(light_inside_a_medium),
        cmocka_unit_test(glow_before_a_background),
        cmocka_unit_test(grey_before_a_coloured_background),
        cmocka_unit_test(glow_that_absorbs_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
