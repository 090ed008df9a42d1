// Pictures of sparse grids against the converged integral: filters, placement, lights, a black body, real smoke.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/folders.h"
#include "tests/support/nanovdb_maker.h"
#include "tests/support/temp_folder.h"
#include "tests/support/true_light.h"
#include "tests/support/volume_maker.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 24, HEIGHT_PX = 16 };

// Three soft lobes, at corners of bricks and away from them, without any symmetry by mirrors or exchanges of axes.
static float lobes(const int voxel[3])
{
    static const double centers[3][3] = {{-9, 0, 8}, {12, -6, 15}, {1, 17, 26}};
    static const double radii[3] = {9, 6, 5}, heights[3] = {1, 0.7, 0.85};
    double value = 0;

    for (int i = 0; i < 3; i++) {
        double square = 0, inside;

        for (int axis = 0; axis < 3; axis++)
            square += pow(voxel[axis] - centers[i][axis], 2);
        inside = fmax(1 - square / (radii[i] * radii[i]), 0);
        value += heights[i] * inside * inside;
    }
    return (float)value;
}

static float heat(const int voxel[3])
{
    return (float)(0.6 + 0.4 * sin(0.2 * voxel[0]) * cos(0.15 * voxel[1] + 0.1 * voxel[2]));
}

static const double OBLIQUE[12] = {0.031, 0.004, -0.002, 0, -0.006, 0.03, 0.005, 0, 0.001, 0.003, -0.035, 0.6};

// Writes a file with two grids: lobes as "density" and heat as "temperature". Returns its path.
static const char *write_lobes(void **state)
{
    struct nanovdb_params params = {.min = {-19, -13, -2}, .max = {19, 23, 32}, .is_zip = true};
    const char *path = temp_folder_path(state, "lobes.nvdb");
    struct nanovdb_made density, temperature;
    unsigned char *both;

    memcpy(params.map, OBLIQUE, sizeof params.map);
    params.name = "density";
    params.value = lobes;
    nanovdb_make(&density, &params);
    params.name = "temperature";
    params.value = heat;
    nanovdb_make(&temperature, &params);
    both = malloc(density.size_bytes + temperature.size_bytes);
    memcpy(both, density.bytes, density.size_bytes);
    memcpy(both + density.size_bytes, temperature.bytes, temperature.size_bytes);
    volume_maker_write(path, both, density.size_bytes + temperature.size_bytes);
    free(both);
    free(density.bytes);
    free(temperature.bytes);
    return path;
}

struct picture {
    const char *file, *density, *medium; // members beside the file, and beside the density; with a comma before
    const char *camera, *lights, *steps;
};

static void assert_true_light(const struct picture *picture, enum gl_backend backend, double tolerance)
{
    struct error error = {{0}};
    struct true_light light;
    struct job job = {0};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"bricks\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [%d, %d],"
             " \"camera\": { %s }, \"lights\": [ %s ], \"scene\": { \"media\": [ { \"density\": { \"kind\": \"grid\","
             " \"file\": \"%s\" %s } %s } ] }, \"quality\": { %s },"
             " \"output\": { \"path\": \"b.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             WIDTH_PX, HEIGHT_PX, picture->camera, picture->lights, picture->file, picture->density, picture->medium,
             picture->steps);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    light = true_light_compare(&job, backend);
    assert_true(true_light_is_within(&light, tolerance));
    job_finish(&job);
}

#define OUTSIDE "\"position\": [1.5, -1.9, 0.9], \"target\": [0, 0, 0.1], \"up\": [0, 0, 1], \"fov\": 40"
#define INSIDE "\"position\": [-0.2, 0.1, 0.3], \"target\": [0.3, 0.2, 0], \"up\": [0, 0, 1], \"fov\": 80"
#define STEPS(N) "\"method\": \"midpoint\", \"step_voxels\": " N ", \"light_step_voxels\": " N
#define LIGHTS                                                                                                         \
    "{\"kind\": \"sun\", \"direction\": [-1, 0.4, -0.6], \"intensity\": [2, 1.5, 1]},"                                 \
    "{\"kind\": \"point\", \"position\": [0.3, -0.8, 0.5], \"intensity\": [0.5, 1, 2]}"
#define SCATTERS ", \"sigma_s\": [9, 8, 7], \"sigma_a\": [2, 3, 4], \"phase\": [{\"g\": 0.5}]"
#define GLOWS ", \"sigma_a\": [3, 4, 5], \"blackbody\": {\"grid\": \"temperature\", \"kelvin\": 1400, \"intensity\": 9}"

// Steps of a quarter voxel are of second order: an error of some 1e-4. Interpolation has kinks at the faces of cells.
static void lit_from_outside_and_inside_the_box(void **state)
{
    const char *path = write_lobes(state);
    struct picture picture = {path, "", SCATTERS, OUTSIDE, LIGHTS, STEPS("0.25")};

    assert_true_light(&picture, GL_BACKEND_SOFTWARE, 8e-4);
    assert_true_light(&picture, GL_BACKEND_EGL, 8e-4);
    picture.camera = INSIDE;
    assert_true_light(&picture, GL_BACKEND_SOFTWARE, 8e-4);
}

static void a_black_body_glows_by_its_temperature(void **state)
{
    struct picture picture = {write_lobes(state), "", GLOWS, OUTSIDE, "", STEPS("0.25")};

    assert_true_light(&picture, GL_BACKEND_SOFTWARE, 8e-4);
    assert_true_light(&picture, GL_BACKEND_EGL, 8e-4);
}

static void voxels_of_other_sides_at_another_position(void **state)
{
    struct picture picture = {write_lobes(state),
                              ", \"spacing\": [0.04, 0.025, 0.03], \"center\": [0.2, -0.1, 0.3]",
                              SCATTERS ", \"blackbody\": {\"grid\": \"temperature\", \"kelvin\": 1400}",
                              OUTSIDE,
                              LIGHTS,
                              STEPS("0.25")};

    assert_true_light(&picture, GL_BACKEND_SOFTWARE, 8e-4);
}

// Opaque values lie between transparent ones. The first function is opaque around 0, too, so that space without active
// voxels and whole bricks of 0 count.
static void a_transfer_function_colours_values(void **state)
{
    struct picture picture = {write_lobes(state),
                              ", \"transfer_function\": [[-0.1, 0, 0.2, 1, 0], [0, 0, 0.2, 1, 0.02], [0.1, 0, 1, 0, 0],"
                              " [0.4, 1, 0.2, 0.1, 0.3], [0.8, 1, 0.9, 0.3, 0]], \"unit_distance\": 0.08",
                              "",
                              OUTSIDE,
                              "",
                              STEPS("0.25")};

    assert_true_light(&picture, GL_BACKEND_SOFTWARE, 2e-3);
    picture.density = ", \"transfer_function\": [[0.1, 0, 1, 0, 0], [0.4, 1, 0.2, 0.1, 0.3], [0.8, 1, 0.9, 0.3, 0]],"
                      " \"unit_distance\": 0.08";
    assert_true_light(&picture, GL_BACKEND_SOFTWARE, 2e-3);
}

// Density jumps between voxels, anywhere in a segment: the error is of first order.
static void nearest_voxels(void **state)
{
    struct picture picture = {write_lobes(state), ", \"interpolation\": \"nearest\"", SCATTERS, OUTSIDE, LIGHTS,
                              STEPS("0.25")};

    assert_true_light(&picture, GL_BACKEND_SOFTWARE, 2e-2);
}

// Light grids lie around the file's box. The tolerance is the error of their cells for a sun and for a light inside.
static void lit_by_light_grids(void **state)
{
    struct picture picture = {write_lobes(state),
                              "",
                              SCATTERS,
                              OUTSIDE,
                              LIGHTS,
                              "\"method\": \"cached\", \"step_voxels\": 0.25, \"light_grid\": 128"};

    assert_true_light(&picture, GL_BACKEND_SOFTWARE, 2e-3);
}

// The simulated gas has up to 1610 K. Its light grows with the ninth power of the temperature and more, so steps of a
// quarter voxel have several times the error of smooth light.
static void a_simulated_fire_is_its_integral(void **state)
{
    struct picture picture = {
        PROJECT_ROOT "/jobs/smoke/smoke.0005.nvdb",
        ", \"grid\": \"density\"",
        ", \"sigma_s\": 10, \"sigma_a\": 1.6,"
        "\"blackbody\": {\"grid\": \"temperature\", \"kelvin\": 560, \"intensity\": 16}",
        "\"position\": [4.1, -4.5, 1.0], \"target\": [1.03, 0.95, 1.0], \"up\": [0, 0, 1], \"fov\": 18",
        "{\"kind\": \"sun\", \"direction\": [-0.5, 0.6, -0.7], \"intensity\": [1.8, 2.0, 2.4]}",
        STEPS("0.25")};

    assert_true_light(&picture, GL_BACKEND_SOFTWARE, 1.5e-2);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(lit_from_outside_and_inside_the_box, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_black_body_glows_by_its_temperature, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(voxels_of_other_sides_at_another_position, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_transfer_function_colours_values, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(nearest_voxels, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(lit_by_light_grids, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(a_simulated_fire_is_its_integral),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
