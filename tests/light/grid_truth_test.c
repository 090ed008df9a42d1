// Pictures of voxel grids against the converged integral: transfer functions, filters, placement, inner cameras, light.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/assert_near.h"
#include "tests/support/load_grid.h"
#include "tests/support/lobes.h"
#include "tests/support/render_frame.h"
#include "tests/support/temp_folder.h"
#include "tests/support/true_light.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 24, HEIGHT_PX = 16 };

#define SKEWED_AXES "space directions: (0.031,-0.006,0.001) (0.004,0.03,0.003) (-0.002,0.005,-0.055)\n"
#define PLAIN_AXES "space directions: (0.04,0,0) (0,0.04,0) (0,0,0.04)\n"

#define OUTSIDE "\"position\": [0.9, 1.1, 0.7], \"target\": [0, 0, 0], \"up\": [0, 0, 1], \"fov\": 45"
#define INSIDE "\"position\": [0.02, 0.05, -0.1], \"target\": [0.3, -0.4, 0.5], \"up\": [0, 0, 1], \"fov\": 70"
#define MIDPOINT(STEPS) "\"method\": \"midpoint\", " STEPS
#define SMOOTH_TRANSFER                                                                                                \
    "\"transfer_function\": [[0.05, 0.1, 0.3, 1, 0], [0.4, 1, 0.2, 0.1, 0.3], [0.9, 1, 0.9, 0.3, 0.9]], "              \
    "\"unit_distance\": 0.08"
#define STEEP_TRANSFER                                                                                                 \
    "\"transfer_function\": [[0.3, 0, 0, 0, 0], [0.31, 1, 0.6, 0.2, 0.97], [0.34, 1, 0.5, 0.1, 0.97],"                 \
    " [0.35, 0, 0, 0, 0], [0.7, 0.2, 0.4, 1, 0], [0.71, 0.2, 0.4, 1, 0.999]], \"unit_distance\": 0.02"

struct picture {
    const char *file, *density, *medium; // medium: members beside the density, with a comma before
    const char *camera, *lights, *quality;
};

static void parse(struct job *job, const struct picture *picture)
{
    struct error error = {{0}};
    char text[8192];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"grid\", \"frames\": \"0\", \"fps\": 24, \"time_offset\": 0.5,"
             " \"resolution\": [%d, %d], \"camera\": { %s }, \"lights\": [ %s ],"
             " \"scene\": { \"media\": [ { \"density\": { \"kind\": \"grid\", \"file\": \"%s\", %s } %s } ] },"
             " \"quality\": { %s },"
             " \"output\": { \"path\": \"grid.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             WIDTH_PX, HEIGHT_PX, picture->camera, picture->lights ? picture->lights : "", picture->file,
             picture->density, picture->medium ? picture->medium : "", picture->quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static struct true_light compare(const struct picture *picture, enum gl_backend backend)
{
    struct true_light light;
    struct job job = {0};

    parse(&job, picture);
    light = true_light_compare(&job, backend);
    job_finish(&job);
    return light;
}

static void assert_true_light(const struct picture *picture, double tolerance)
{
    struct true_light light = compare(picture, GL_BACKEND_SOFTWARE);

    assert_true(true_light_is_within(&light, tolerance));
}

static const int SIZE[3] = {21, 17, 19};

// Steps of a quarter voxel are of second order: an error of some 1e-3. Interpolation has kinks at the faces of cells.
static void transfer_function_on_both_backends(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");
    struct picture picture = {path, SMOOTH_TRANSFER, .camera = OUTSIDE, .quality = MIDPOINT("\"step_voxels\": 0.25")};
    struct true_light light;

    lobes_write(path, SIZE, PLAIN_AXES);
    assert_true_light(&picture, 1e-3);
    light = compare(&picture, GL_BACKEND_EGL);
    assert_true(true_light_is_within(&light, 1e-3));
}

static void oblique_flat_mirrored_voxels(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");

    lobes_write(path, SIZE, SKEWED_AXES);
    assert_true_light(
        &(struct picture){path, SMOOTH_TRANSFER, .camera = OUTSIDE, .quality = MIDPOINT("\"step_voxels\": 0.25")},
        1e-3);
}

static void camera_inside_the_box(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");

    lobes_write(path, SIZE, SKEWED_AXES);
    assert_true_light(
        &(struct picture){path, SMOOTH_TRANSFER, .camera = INSIDE, .quality = MIDPOINT("\"step_voxels\": 0.25")}, 1e-3);
}

// Density jumps between voxels, anywhere in a segment: the error is of first order.
static void nearest_voxels(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");

    lobes_write(path, SIZE, SKEWED_AXES);
    assert_true_light(&(struct picture){path, SMOOTH_TRANSFER ", \"interpolation\": \"nearest\"", .camera = OUTSIDE,
                                        .quality = MIDPOINT("\"step_voxels\": 0.02")},
                      2e-3);
}

// Opacity rises within a hundredth of the range of values: shells are some tenths of a millimetre thin.
static void steep_transfer_function(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");

    lobes_write(path, SIZE, PLAIN_AXES);
    assert_true_light(
        &(struct picture){path, STEEP_TRANSFER, .camera = OUTSIDE, .quality = MIDPOINT("\"step_voxels\": 0.004")},
        2e-3);
}

static void moved_and_respaced(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");

    lobes_write(path, SIZE, SKEWED_AXES);
    assert_true_light(&(struct picture){path,
                                        SMOOTH_TRANSFER ", \"spacing\": [0.03, 0.05, 0.02], \"center\": "
                                                        "{ \"start\": [0, 0.1, 0], \"rate\": [0.2, -0.3, 0.1] }",
                                        .camera = OUTSIDE, .quality = MIDPOINT("\"step_voxels\": 0.25")},
                      1e-3);
}

static void lit_scan(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");

    lobes_write(path, SIZE, SKEWED_AXES);
    assert_true_light(
        &(struct picture){path, "\"scale\": 20",
                          ", \"sigma_s\": [0.5, 0.8, 1], \"sigma_a\": 0.2, \"phase\": [{\"g\": 0.4}]", OUTSIDE,
                          "{ \"kind\": \"sun\", \"intensity\": 3, \"direction\": [-1, 0.3, -0.8] },"
                          "{ \"kind\": \"point\", \"intensity\": [1, 0.5, 0.2], \"position\": [0.1, -0.05, 0.2] }",
                          MIDPOINT("\"step_voxels\": 0.2, \"light_step_voxels\": 0.2")},
        1e-3);
}

static void grids_of_one_and_two_voxels(void **state)
{
    const char *path = temp_folder_path(state, "tiny.nrrd");

    for (int i = 1; i <= 2; i++) {
        lobes_write(path, (int[]){i, 1, 1}, "space directions: (0.3,0.05,0) (0,0.4,0) (0,0,0.5)\n");
        assert_true_light(&(struct picture){path, "\"scale\": 30", ", \"sigma_a\": 1, \"emission\": [1, 2, 3]", OUTSIDE,
                                            .quality = MIDPOINT("\"step_voxels\": 0.01")},
                          1e-3);
    }
}

// Opacity converges to the integral: half the step leaves a quarter of the error.
static void opacity_does_not_depend_on_the_step(void **state)
{
    static const char *const steps[] = {MIDPOINT("\"step_voxels\": 1"), MIDPOINT("\"step_voxels\": 0.5"),
                                        MIDPOINT("\"step_voxels\": 0.25")};
    const char *path = temp_folder_path(state, "lobes.nrrd");
    double error[3];

    lobes_write(path, SIZE, PLAIN_AXES);
    for (int i = 0; i < 3; i++)
        error[i] = compare(&(struct picture){path, SMOOTH_TRANSFER, .camera = OUTSIDE, .quality = steps[i]},
                           GL_BACKEND_SOFTWARE)
                       .radiance.relative_rmse;
    assert_true(error[0] < 0.02);
    assert_true(error[0] / error[2] > 8); // 16 without the kinks of interpolation
}

static void riemann_sums_end_at_the_box_too(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");

    lobes_write(path, SIZE, SKEWED_AXES);
    assert_true_light(&(struct picture){path, SMOOTH_TRANSFER, .camera = OUTSIDE ", \"clip\": [0.5, 3]",
                                        .quality = "\"method\": \"riemann\", \"step\": 0.001, \"light_steps\": 1"},
                      0.01);
}

static void two_grids_overlap(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");
    char density[1024];

    lobes_write(path, SIZE, SKEWED_AXES);
    // The text of the first density closes its medium and opens the second one in the same list.
    snprintf(density, sizeof density,
             SMOOTH_TRANSFER
             " } }, { \"density\": { \"kind\": \"grid\", \"file\": \"%s\", \"spacing\": [0.05, 0.03, 0.02],"
             " \"center\": [0.1, -0.1, 0.05], \"scale\": 15",
             path);
    assert_true_light(&(struct picture){path, density, ", \"sigma_a\": 1, \"emission\": [0.2, 0.9, 0.5]", OUTSIDE,
                                        .quality = MIDPOINT("\"step_voxels\": 0.25")},
                      1e-3);
}

// Segments end where the bounds end. The falloff is a cubic.
static void bounds_fall_off_inside_a_grid(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");

    lobes_write(path, SIZE, SKEWED_AXES);
    assert_true_light(
        &(struct picture){path,
                          "\"scale\": 20, \"bounds\": { \"kind\": \"sphere\", \"center\": [-0.1, 0.05, 0.1],"
                          " \"radius\": 0.3, \"falloff\": 0.15 }",
                          ", \"sigma_a\": [1, 2, 3], \"emission\": [0.2, 0.9, 0.5]", OUTSIDE,
                          .quality = MIDPOINT("\"step_voxels\": 0.25")},
        1e-3);
}

// Depth is where transmittance is a half. The picture has it within a step, 0.01, of the reference's.
static void depth_of_a_coloured_scan(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");
    struct still *still = calloc(1, sizeof *still);
    struct still_inputs inputs;
    struct image image;
    struct job job = {0};
    int found = 0;

    lobes_write(path, SIZE, PLAIN_AXES);
    parse(&job,
          &(struct picture){path, SMOOTH_TRANSFER, .camera = OUTSIDE, .quality = MIDPOINT("\"step_voxels\": 0.25")});
    render_frame_zero(&job, &image);
    load_grid_inputs(&inputs, &job, 0);
    still_init_with_inputs(still, &job, job_frame_time(&job, 0), &inputs);
    for (int i = 0; i < WIDTH_PX * HEIGHT_PX; i++) {
        double wanted = reference_measure_depth(still, i % WIDTH_PX, i / WIDTH_PX);

        if (wanted == 0 && image.depth[i] == 0) continue;
        assert_near((double)image.depth[i], wanted, 0.01);
        found++;
    }
    assert_true(found > 10);
    load_grid_finish(&inputs);
    image_finish(&image);
    job_finish(&job);
    free(still);
}

int main(int argc, char *argv[])
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(transfer_function_on_both_backends),
        TEST(oblique_flat_mirrored_voxels),
        TEST(camera_inside_the_box),
        TEST(nearest_voxels),
        TEST(steep_transfer_function),
        TEST(moved_and_respaced),
        TEST(lit_scan),
        TEST(two_grids_overlap),
        TEST(bounds_fall_off_inside_a_grid),
        TEST(depth_of_a_coloured_scan),
        TEST(grids_of_one_and_two_voxels),
        TEST(opacity_does_not_depend_on_the_step),
        TEST(riemann_sums_end_at_the_box_too),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
