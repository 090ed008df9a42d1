// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_rules.h"

#include "tests/support/job_expect.h"
#include "tests/support/job_text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_edit_refused(const char *path, const char *value, const char *expected)
{
    job_expect_edit_refused(job_text_grid, path, value, expected);
}

static void every_key_of_a_grid_is_read(void **state)
{
    struct job job = job_expect(job_text_grid);
    const struct scene_grid *grid = &job.scene.media[0].density.grid;
    const struct scene_transfer_point *point = &grid->points[1];

    assert_int_equal(job.scene.media[0].density.kind, SCENE_DENSITY_GRID);
    assert_string_equal(grid->file, "/data/head.raw");
    assert_null(grid->grid_name);
    assert_true(grid->raw.size[0] == 64 && grid->raw.size[1] == 32 && grid->raw.size[2] == 16);
    assert_true(grid->raw.has_type && grid->raw.type == SCENE_VOXEL_INT16 && grid->raw.is_big_endian);
    assert_int_equal(grid->raw.skip_bytes, 7);
    assert_true(grid->spacing[0] == 0.01 && grid->spacing[1] == 0.02 && grid->spacing[2] == 0.03);
    assert_true(grid->is_nearest && grid->has_center && grid->center.linear.rate[0] == 1.0);
    assert_int_equal(grid->point_count, 3);
    assert_true(point->value == 0.25 && point->rgba[0] == 1.0 && point->rgba[1] == 2.0 && point->rgba[2] == 3.0);
    assert_true(point->rgba[3] == 0.5 && grid->points[2].rgba[3] == 0.999999);
    assert_true(grid->unit_distance.linear.start[0] == 0.01);
    assert_true(job.quality.step_voxels == 0.5 && job.quality.light_step_voxels == 2.0 && job.quality.step == 0.0);
    job_finish(&job);
}

static void a_grid_has_defaults(void **state)
{
    struct job job = job_expect(job_text_grid);
    const struct scene_grid *grid = &job.scene.media[2].density.grid;

    assert_true(grid->raw.size[0] == 0 && !grid->raw.has_type && !grid->raw.is_big_endian && grid->spacing[0] == 0.0);
    assert_false(grid->is_nearest || grid->has_center);
    assert_int_equal(grid->point_count, 0);
    assert_true(grid->scale.value[0] == 1.0 && job.scene.media[2].blackbody.intensity.value[0] == 1.0);
    job_finish(&job);
}

static void blackbody_is_read(void **state)
{
    struct job job = job_expect(job_text_grid);
    const struct scene_medium *smoke = &job.scene.media[1];

    assert_string_equal(smoke->density.grid.grid_name, "density");
    assert_true(smoke->density.grid.scale.value[0] == 3.0);
    assert_string_equal(smoke->blackbody.grid_name, "temperature");
    assert_true(smoke->blackbody.kelvin.linear.start[0] == 1500.0 && smoke->blackbody.intensity.value[0] == 2.0);
    assert_null(job.scene.media[0].blackbody.grid_name);
    job_finish(&job);
}

static void a_file_a_frame_is_a_sequence(void **state)
{
    struct job job = job_expect(job_text_grid);

    assert_false(scene_density_is_sequence(&job.scene.media[0].density));
    assert_true(scene_density_is_sequence(&job.scene.media[1].density));
    assert_false(scene_density_is_sequence(&job.scene.media[2].density));
    job_finish(&job);
}

static void wrong_files_are_refused_by_place(void **state)
{
    assert_edit_refused("scene.media[0].density.file", NULL,
                        "scene.media[0].density.file: expected a string, got nothing");
    assert_edit_refused("scene.media[2].density.file", "\"a#b#.nvdb\"",
                        "scene.media[2].density.file: expected one run of # for the frame's number, got two");
    assert_edit_refused("scene.media[2].density.file", "\"head.hdr\"",
                        "scene.media[2].density.file: expected a name that ends in .raw, .nrrd, .nhdr, .nii, .nii.gz, "
                        ".nvdb or .vdb, got \"head.hdr\"");
    assert_edit_refused("scene.media[0].density.file", "\"head.nrrd\"",
                        "scene.media[0].density.size: only for .raw files; the headers of others have it");
    assert_edit_refused("scene.media[0].density.grid", "\"density\"",
                        "scene.media[0].density.grid: only .nvdb and .vdb files have named grids");
    assert_edit_refused("scene.media[0].density.size", "[64,0,16]",
                        "scene.media[0].density.size[1]: expected an integer from 1 to 65536, got 0");
    assert_edit_refused("scene.media[0].density.type", "\"int32\"",
                        "scene.media[0].density.type: expected one of \"uint8\",\"uint16\",\"int16\",\"float32\", got "
                        "\"int32\", did you mean \"int16\"?");
    assert_edit_refused("scene.media[0].density.spacing", "[1,-1,1]",
                        "scene.media[0].density.spacing[1]: expected a number from 1e-09 to 1000000000, got -1");
}

static void wrong_transfer_functions_are_refused_by_place(void **state)
{
    assert_edit_refused("scene.media[0].density.transfer_function[1][0]", "-1",
                        "scene.media[0].density.transfer_function[1][0]: expected a value above that of the point "
                        "before it (-1), got -1");
    assert_edit_refused("scene.media[0].density.transfer_function[2][4]", "1",
                        "scene.media[0].density.transfer_function[2][4]: expected a number from 0 to 0.999999, got 1");
    assert_edit_refused("scene.media[0].density.transfer_function[2]", "[3,1,1,0.5]",
                        "scene.media[0].density.transfer_function[2]: expected [value, r, g, b, a], got an array of 4");
    assert_edit_refused("scene.media[0].density.transfer_function", "[[0,0,0,0,0]]",
                        "scene.media[0].density.transfer_function: expected an array of 2 to 64, got an array of 1");
    assert_edit_refused("scene.media[0].density.unit_distance", NULL,
                        "scene.media[0].density.unit_distance: expected a number in (0, 1000000000], got nothing");
    assert_edit_refused("scene.media[1].density.unit_distance", "1",
                        "scene.media[1].density.unit_distance: only beside a transfer_function");
    assert_edit_refused("scene.media[0].density.scale", "1",
                        "scene.media[0].density.scale: not beside a transfer_function, which says what a value means");
}

static void coefficients_do_not_stand_beside_a_transfer_function(void **state)
{
    static const char *const members[][2] = {{"sigma_s", "1"},
                                             {"sigma_a", "1"},
                                             {"emission", "1"},
                                             {"phase", "[{\"g\":0}]"},
                                             {"blackbody", "{\"grid\":\"t\",\"kelvin\":1}"}};

    for (size_t i = 0; i < sizeof members / sizeof members[0]; i++) {
        char path[64], expected[160];

        snprintf(path, sizeof path, "scene.media[0].%s", members[i][0]);
        snprintf(expected, sizeof expected,
                 "%s: not beside a transfer_function, which says how light is absorbed and emitted", path);
        assert_edit_refused(path, members[i][1], expected);
    }
}

static void blackbody_needs_a_file_of_named_grids(void **state)
{
    static const char only[] = "scene.media[1].blackbody: only beside a density of kind \"grid\" from a .nvdb or .vdb "
                               "file, which holds its temperature";

    assert_edit_refused("scene.media[1].density", "{\"kind\":\"grid\",\"file\":\"a.nii\"}", only);
    assert_edit_refused("scene.media[1].density", "{\"kind\":\"homogeneous\"}", only);
    assert_edit_refused("scene.media[1].blackbody.grid", NULL,
                        "scene.media[1].blackbody.grid: expected a string, got nothing");
    assert_edit_refused("scene.media[1].blackbody.kelvin", "-1",
                        "scene.media[1].blackbody.kelvin: expected a number in [0, 1000000000], got -1");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_of_a_grid_is_read),
        cmocka_unit_test(a_grid_has_defaults),
        cmocka_unit_test(blackbody_is_read),
        cmocka_unit_test(a_file_a_frame_is_a_sequence),
        cmocka_unit_test(wrong_files_are_refused_by_place),
        cmocka_unit_test(wrong_transfer_functions_are_refused_by_place),
        cmocka_unit_test(coefficients_do_not_stand_beside_a_transfer_function),
        cmocka_unit_test(blackbody_needs_a_file_of_named_grids),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
