// SPDX-License-Identifier: Apache-2.0
#include "reference/still.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/closed_form.h"
#include "reference/reference.h"
#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE_PX = 5 };

// The camera at z = 4 looks at the origin. `media` stands between the brackets, `rest` is members of the job.
static void parse(struct job *job, const char *media, const char *rest)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{\"version\": 1, \"name\": \"still\", \"frames\": \"0-9\", \"fps\": 10, \"resolution\": [%d, %d],"
             " \"camera\": {\"position\": [0, 0, 4], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 40,"
             " \"clip\": [0, 50], \"shutter\": 1},"
             " \"scene\": {\"media\": [%s]}, %s,"
             " \"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.05},"
             " \"output\": {\"path\": \"still.####.exr\"}}",
             SIDE_PX, SIDE_PX, media, rest);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static double centre_transmittance(const char *media)
{
    struct reference_pixel pixel;
    struct still still;
    struct job job;

    parse(&job, media, "\"lights\": []");
    still_init(&still, &job, 0.5);
    assert_true(still.is_complete);
    pixel = reference_measure_pixel(&still, SIDE_PX / 2, SIDE_PX / 2, NULL);
    job_finish(&job);
    return pixel.transmittance[0];
}

static void bounds_cut_media_as_their_closed_forms_say(void **state)
{
    // 1e-4 of the share is the integrator's accuracy.
    assert_near(centre_transmittance("{\"density\": {\"kind\": \"homogeneous\", \"scale\": 2, \"bounds\": {\"kind\": "
                                     "\"sphere\", \"center\": [0.3, 0, 0], \"radius\": 0.5}}, \"sigma_a\": 0.7}"),
                exp(-1.4 * closed_form_sphere_chord(0.5, 0.3)), 1e-4);
    assert_near(centre_transmittance("{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"box\", "
                                     "\"size\": {\"start\": [1, 1, 1], \"rate\": [0, 0, 2]}}}, \"sigma_a\": 0.7}"),
                exp(-0.7 * 2.0), 1e-4);
    assert_near(centre_transmittance("{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"slab\", "
                                     "\"normal\": [0, 3, 4], \"thickness\": 0.4}}, \"sigma_a\": 0.7}"),
                exp(-0.7 * closed_form_slab_length(0.4, 0.8)), 1e-4);
    // The integral of a smoothstep over its width is half of the width.
    assert_near(centre_transmittance("{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"slab\", "
                                     "\"normal\": [0, 0, 1], \"thickness\": 1, \"falloff\": 0.3}}, \"sigma_a\": 0.7}"),
                exp(-0.7 * 0.7), 1e-4);
    // The clip distances end a medium that has no other end.
    assert_near(centre_transmittance("{\"density\": {\"kind\": \"homogeneous\"}, \"sigma_a\": 0.02}"),
                exp(-0.02 * 50.0), 1e-4);
}

static void rayleigh_lobes_scatter_as_such(void **state)
{
    struct reference_pixel pixel;
    struct still still;
    struct job job;
    double wanted;

    parse(&job,
          "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"slab\", \"normal\": [0, 0, 1], "
          "\"thickness\": 1}}, \"sigma_s\": 0.5, \"phase\": [{\"kind\": \"rayleigh\"}]}",
          "\"lights\": [{\"kind\": \"sun\", \"intensity\": 2, \"direction\": [0, 0, -1]}]");
    still_init(&still, &job, 0.0);
    pixel = reference_measure_pixel(&still, SIDE_PX / 2, SIDE_PX / 2, NULL);
    wanted = closed_form_front_lit_slab(0.5, 0.5, 1.0, 3.0 / (8.0 * M_PI), 2.0);
    assert_near(pixel.radiance[0], wanted, 1e-4 * wanted);
    job_finish(&job);
}

#define FALLING_OFF                                                                                                    \
    ", \"bounds\": {\"kind\": \"sphere\", \"center\": [0.1, 0.2, 0], \"radius\": 0.9, \"falloff\": 0.4}}"
#define GLOWING ", \"sigma_a\": [3, 1, 20], \"emission\": [3, 1, 20]}"

static void furnace_hides_every_kind(void **state)
{
    static const char *const MEDIA[] = {
        "{\"density\": {\"kind\": \"homogeneous\"" FALLING_OFF GLOWING,
        "{\"density\": {\"kind\": \"noise\", \"frequency\": 4, \"octaves\": 4" FALLING_OFF GLOWING,
        "{\"density\": {\"kind\": \"noise\", \"frequency\": 4, \"octaves\": 3, \"mode\": \"clip\", \"bias\": 0.3, "
        "\"scale\": 5" FALLING_OFF GLOWING,
        "{\"density\": {\"kind\": \"noise\", \"frequency\": 4, \"octaves\": 3, \"mode\": \"absolute\"" FALLING_OFF
            GLOWING,
        "{\"density\": {\"kind\": \"fold_fractal\", \"iterations\": 3, \"offset\": 0.2, \"radius\": 0.5, \"exponent\": "
        "1.3, "
        "\"scale\": 5, \"rotate_x_rad\": 0.4" FALLING_OFF GLOWING,
    };
    char all[4096];

    snprintf(all, sizeof all, "%s, %s, %s", MEDIA[0], MEDIA[1], MEDIA[4]);
    for (size_t i = 0; i <= sizeof MEDIA / sizeof MEDIA[0]; i++) {
        struct still still;
        struct job job;

        parse(&job, i < sizeof MEDIA / sizeof MEDIA[0] ? MEDIA[i] : all, "\"lights\": [], \"background\": 1");
        still_init(&still, &job, 0.0);
        for (int p = 0; p < SIDE_PX * SIDE_PX; p++) {
            struct reference_pixel pixel = reference_measure_pixel(&still, p % SIDE_PX, p / SIDE_PX, NULL);

            assert_true(pixel.is_converged);
            for (int c = 0; c < 3; c++)
                assert_near(pixel.radiance[c], 1.0, 1e-4);
        }
        job_finish(&job);
    }
}

static void samples_are_averaged_each_at_its_own_moment(void **state)
{
    const struct reference_sample samples[] = {{0.5, 0.5, 0.0, 0}, {0.5, 0.5, 1.0, 0}, {0.5, 0.5, 0.4, 0}};
    struct reference_pixel pixel;
    struct job job;
    double wanted = (exp(-0.5) + exp(-1.5) + exp(-0.9)) / 3.0;

    parse(&job,
          "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"slab\", \"normal\": [0, 0, 1], "
          "\"thickness\": {\"start\": 0.5, \"rate\": 1}}}, \"sigma_a\": [1, 0, 0], \"emission\": [0, 2, 0]}",
          "\"lights\": []");
    pixel = reference_measure_samples(&job, NULL, SIDE_PX / 2, SIDE_PX / 2, samples, 3, NULL);
    assert_near(pixel.transmittance[0], wanted, 1e-4);
    assert_near(pixel.radiance[1], 2.0 * (0.5 + 1.5 + 0.9) / 3.0, 1e-4);
    assert_near(pixel.alpha, (1.0 - wanted) / 3.0, 1e-4);
    assert_true(pixel.is_converged);
    job_finish(&job);
}

// The box's face lies half a pixel to the right of the middle pixel's left edge: the pixel's left half sees nothing.
static void samples_lie_at_their_points_in_the_pixel(void **state)
{
    const struct reference_sample left = {0.25, 0.5, 0.0, 0}, right = {0.75, 0.5, 0.0, 0}, up = {0.75, 0.1, 0.0, 0};
    struct job job;

    parse(&job,
          "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"box\", \"center\": [1, -1, 0], "
          "\"size\": [2, 2.02, 0.1]}}, \"sigma_a\": 10}",
          "\"lights\": []");
    assert_near(reference_measure_samples(&job, NULL, 2, 2, &left, 1, NULL).alpha, 0.0, 0.0);
    assert_true(reference_measure_samples(&job, NULL, 2, 2, &right, 1, NULL).alpha > 0.5);
    assert_near(reference_measure_samples(&job, NULL, 2, 2, &up, 1, NULL).alpha, 0.0, 0.0);
    job_finish(&job);
}

// Half of the light is left after ln 2 / 0.02 m, wherever the fog may end.
static void depth_is_found_in_fog_without_end(void **state)
{
    struct still still;
    struct job job;

    parse(&job, "{\"density\": {\"kind\": \"homogeneous\"}, \"sigma_a\": 0.02}", "\"lights\": []");
    job.scene.camera.clip_far = INFINITY;
    still_init(&still, &job, 0.0);
    assert_near(reference_measure_depth(&still, SIDE_PX / 2, SIDE_PX / 2), log(2.0) / 0.02, 1e-9);
    job_finish(&job);
}

static double ramp_of(const void *context, struct vec3 position, double time)
{
    return *(const double *)context * position.z + time;
}

static void functions_stand_for_densities_in_glsl(void **state)
{
    struct still_inputs inputs = {.functions = {{NULL, NULL}}};
    struct reference_pixel pixel;
    struct still still;
    double slope = 2.0;
    struct job job;

    parse(&job,
          "{\"density\": {\"kind\": \"homogeneous\", \"scale\": 3, \"bounds\": {\"kind\": \"box\", \"size\": [1, 1, "
          "2]}}, "
          "\"sigma_a\": 0.5}",
          "\"lights\": []");
    // The GLSL source is not read: only a renderer would need it.
    job.scene.media[0].density.glsl = (struct scene_glsl){.scale = {.component_count = 1, .value = {3.0}}};
    job.scene.media[0].density.kind = SCENE_DENSITY_GLSL;
    still_init(&still, &job, 0.5);
    assert_false(still.is_complete);
    inputs.functions[0] = (struct still_function){ramp_of, &slope};
    still_init_with_inputs(&still, &job, 0.5, &inputs);
    assert_true(still.is_complete);
    pixel = reference_measure_pixel(&still, SIDE_PX / 2, SIDE_PX / 2, NULL);
    // The density is max(2 z + 0.5, 0) from z = -0.25 to 1.
    assert_near(pixel.transmittance[0], exp(-0.5 * 3.0 * closed_form_ramp_column(0.0, 2.5, 1.25)), 1e-4);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_cut_media_as_their_closed_forms_say),
        cmocka_unit_test(rayleigh_lobes_scatter_as_such),
        cmocka_unit_test(furnace_hides_every_kind),
        cmocka_unit_test(samples_are_averaged_each_at_its_own_moment),
        cmocka_unit_test(samples_lie_at_their_points_in_the_pixel),
        cmocka_unit_test(depth_is_found_in_fog_without_end),
        cmocka_unit_test(functions_stand_for_densities_in_glsl),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
