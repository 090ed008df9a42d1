// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/truth_files.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/exr_maker.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void dome_is_read_as_the_file_has_it(void **state)
{
    static const float first[] = {1, 2, 3, 4, 5, 3e5f}, second[] = {7, 8, 9};
    char *file = strdup(temp_folder_path(state, "sky.exr"));
    struct truth_files files = {0};
    struct error error = {{0}};
    struct job job = {0};

    job.scene.light_count = 1;
    job.scene.lights[0].kind = SCENE_LIGHT_DOME;
    job.scene.lights[0].dome =
        (struct scene_dome){.kind = SCENE_DOME_FILE, .image = {.file = file, .is_linear = true, .is_radiance = true}};
    exr_maker_write(file, 2, 1, JOB_PIXEL_FLOAT, first);
    if (!truth_files_load(&files, &job, 0, &error)) fail_msg("%s", error.message);
    assert_true(files.inputs.dome.width == 2 && files.inputs.dome.height == 1);
    assert_memory_equal(files.inputs.dome.rgb, first, sizeof first);
    exr_maker_write(file, 1, 1, JOB_PIXEL_FLOAT, second);
    if (!truth_files_load(&files, &job, 0, &error)) fail_msg("%s", error.message);
    assert_true(files.inputs.dome.width == 1 && files.inputs.dome.height == 1);
    assert_memory_equal(files.inputs.dome.rgb, second, sizeof second);
    truth_files_finish(&files);
    assert_null(files.inputs.dome.rgb);
    free(file);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(dome_is_read_as_the_file_has_it),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
