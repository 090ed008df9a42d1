// The preintegrated method, a lookup for a whole segment, against the converged integral and the midpoint method.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/lobes.h"
#include "tests/support/temp_folder.h"
#include "tests/support/true_light.h"
#include "tests/support/volume_maker.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define SKEWED_AXES "space directions: (0.031,-0.006,0.001) (0.004,0.03,0.003) (-0.002,0.005,-0.055)\n"
#define PLAIN_AXES "space directions: (0.04,0,0) (0,0.04,0) (0,0,0.04)\n"

#define SOFT                                                                                                           \
    "\"transfer_function\": [[0.05, 0.1, 0.3, 1, 0], [0.4, 1, 0.2, 0.1, 0.3], [0.9, 1, 0.9, 0.3, 0.9]], "              \
    "\"unit_distance\": 0.08"
// A shell is a hundredth of the range of values thin. Another shell of another colour is inside.
#define STEEP                                                                                                          \
    "\"transfer_function\": [[0.3, 0, 0, 0, 0], [0.31, 1, 0.6, 0.2, 0.97], [0.34, 1, 0.5, 0.1, 0.97],"                 \
    " [0.35, 0, 0, 0, 0], [0.7, 0.2, 0.4, 1, 0], [0.71, 0.2, 0.4, 1, 0.999]], \"unit_distance\": 0.02"
// Values rise linearly from 0 to 200 between the centres of two voxels. One colour hides another one behind it.
#define LAYERS                                                                                                         \
    "\"spacing\": [0.5, 2, 2], \"center\": [0, 0, 0], \"transfer_function\": [[10, 0, 0.2, 1, 0.9],"                   \
    " [100, 0, 0.2, 1, 0.9], [101, 1, 0, 0, 0.9], [190, 1, 0.5, 0, 0.5]], \"unit_distance\": 0.3, \"bounds\": { "      \
    "\"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [0.5, 2, 2] }"
#define GRID(FILE_FORMAT, MEMBERS) "{ \"density\": { \"kind\": \"grid\", \"file\": \"" FILE_FORMAT "\", " MEMBERS " } }"
#define STEPS(METHOD, VOXELS) "\"method\": \"" METHOD "\", \"step_voxels\": " VOXELS

struct picture {
    const char *file;
    const char *media; // @ stands for the file's path
    const char *lights, *quality;
};

static void put_file(char *media, size_t size, const struct picture *picture)
{
    size_t length = 0;

    media[0] = 0;
    for (const char *at = picture->media; *at && length < size; at++)
        length += *at == '@' ? (size_t)snprintf(media + length, size - length, "%s", picture->file)
                             : (size_t)snprintf(media + length, size - length, "%c", *at);
    assert_true(length < size);
}

static struct true_light compare_on(const struct picture *picture, enum gl_backend backend)
{
    struct error error = {{0}};
    struct true_light light;
    struct job job = {0};
    char media[4096], text[8192];

    put_file(media, sizeof media, picture);
    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"grid\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [24, 16],"
             " \"camera\": { \"position\": [0.9, 1.1, 0.7], \"target\": [0, 0, 0], \"up\": [0, 0, 1], \"fov\": 45 },"
             " \"lights\": [ %s ], \"scene\": { \"media\": [ %s ] }, \"quality\": { %s },"
             " \"output\": { \"path\": \"grid.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             picture->lights ? picture->lights : "", media, picture->quality);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    light = true_light_compare(&job, backend);
    job_finish(&job);
    return light;
}

static struct true_light compare(const struct picture *picture)
{
    return compare_on(picture, GL_BACKEND_SOFTWARE);
}

static const int SIZE[3] = {21, 17, 19};

static void soft_functions_on_both_backends(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");
    const struct picture picture = {path, GRID("@", SOFT), .quality = STEPS("preintegrated", "0.25")};
    struct true_light light;

    lobes_write(path, SIZE, SKEWED_AXES);
    light = compare(&picture);
    assert_true(true_light_is_within(&light, 1e-3));
    light = compare_on(&picture, GL_BACKEND_EGL);
    assert_true(true_light_is_within(&light, 1e-3));
}

// Half the step leaves a quarter of the error, kinks of interpolation aside.
static void soft_functions_are_of_second_order(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");
    struct true_light coarse, fine;

    lobes_write(path, SIZE, PLAIN_AXES);
    coarse = compare(&(struct picture){path, GRID("@", SOFT), .quality = STEPS("preintegrated", "1")});
    fine = compare(&(struct picture){path, GRID("@", SOFT), .quality = STEPS("preintegrated", "0.25")});
    assert_true(coarse.radiance.relative_rmse < 0.02);
    assert_true(coarse.radiance.relative_rmse / fine.radiance.relative_rmse > 8);
}

// A shell between two samples is not missed.
static void thin_shells_need_fewer_steps_than_by_midpoint(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");
    struct true_light midpoint, light;

    lobes_write(path, SIZE, PLAIN_AXES);
    for (int i = 0; i < 2; i++) {
        static const char *const steps[2][2] = {{STEPS("midpoint", "0.5"), STEPS("preintegrated", "0.5")},
                                                {STEPS("midpoint", "0.1"), STEPS("preintegrated", "0.1")}};

        midpoint = compare(&(struct picture){path, GRID("@", STEEP), .quality = steps[i][0]});
        light = compare(&(struct picture){path, GRID("@", STEEP), .quality = steps[i][1]});
        assert_true(light.radiance.relative_rmse < 0.25 * midpoint.radiance.relative_rmse);
        assert_true(light.transmittance.relative_rmse < 0.25 * midpoint.transmittance.relative_rmse);
    }
}

static void thin_shells_converge(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");
    struct true_light light;

    lobes_write(path, SIZE, SKEWED_AXES);
    light = compare(&(struct picture){path, GRID("@", STEEP), .quality = STEPS("preintegrated", "0.04")});
    assert_true(true_light_is_within(&light, 2e-3));
}

static void front_of_a_segment_hides_its_rest(void **state)
{
    const char *path = temp_folder_path(state, "ramp_2x1x1xuint8.raw");
    struct true_light light;

    volume_maker_write(path, (const unsigned char[]){0, 200}, 2);
    light = compare(&(struct picture){path, GRID("@", LAYERS), .quality = STEPS("preintegrated", "1")});
    assert_true(light.radiance.relative_rmse < 0.06); // 0.35 without a lookup between the ends
}

// Two grids with transfer functions overlap. One ends with a falloff within the other's box. The third medium is lit.
static void tables_beside_other_media(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");
    struct true_light light;

    lobes_write(path, SIZE, SKEWED_AXES);
    light = compare(&(struct picture){
        path,
        GRID("@", SOFT) ", " GRID(
            "@", SOFT ", \"spacing\": [0.05, 0.03, 0.02], \"center\": [0.1, -0.1, 0.05],"
                      " \"bounds\": { \"kind\": \"sphere\", \"center\": [0.1, -0.1, 0.05], \"radius\": 0.3,"
                      " \"falloff\": 0.1 }") ", { \"density\": { \"kind\": \"homogeneous\","
                                             " \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0],"
                                             " \"radius\": 0.5, \"falloff\": 0.1 } }, \"sigma_s\": [0.5, 1, 2] }",
        "{ \"kind\": \"sun\", \"intensity\": 3, \"direction\": [-1, 0.3, -0.8] }",
        STEPS("preintegrated", "0.25") ", \"light_step_voxels\": 0.5"});
    assert_true(true_light_is_within(&light, 2e-3));
}

static void nearest_voxels_are_those_of_the_middle(void **state)
{
    const char *path = temp_folder_path(state, "lobes.nrrd");
    struct true_light midpoint, light;

    lobes_write(path, SIZE, SKEWED_AXES);
    midpoint = compare(&(struct picture){path, GRID("@", SOFT ", \"interpolation\": \"nearest\""),
                                         .quality = STEPS("midpoint", "0.3")});
    light = compare(&(struct picture){path, GRID("@", SOFT ", \"interpolation\": \"nearest\""),
                                      .quality = STEPS("preintegrated", "0.3")});
    assert_true(light.radiance.relative_rmse == midpoint.radiance.relative_rmse);
}

int main(int argc, char *argv[])
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(soft_functions_on_both_backends),
        TEST(soft_functions_are_of_second_order),
        TEST(thin_shells_need_fewer_steps_than_by_midpoint),
        TEST(thin_shells_converge),
        TEST(front_of_a_segment_hides_its_rest),
        TEST(tables_beside_other_media),
        TEST(nearest_voxels_are_those_of_the_middle),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
