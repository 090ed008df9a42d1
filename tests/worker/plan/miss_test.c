// What is said of a frame that missed its tolerance names what paths above the first order were tried.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/picture/audit_result.h"
#include "worker/plan/miss.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static struct error message_of(struct job_quality quality)
{
    struct job job = {.quality.tolerance = 0.01};
    struct audit_result audit = {.error = 0.02, .spread = 0.001, .error95 = 0.022};
    struct error error = {{0}};

    miss_describe(
        &(struct miss){
            .job = &job, .quality = &quality, .audit = &audit, .first_error = 0.03, .rendering_count = 2, .work = 3.0},
        &error);
    return error;
}

static void paths_of_pixels_and_grids_of_lights_are_named(void **state)
{
    struct error error = message_of((struct job_quality){.method = JOB_METHOD_PATHS, .paths = 4096, .light_grid = 64});

    (void)state;
    assert_non_null(strstr(error.message, "at best, by paths, light_grid 64, paths 4096; "));
}

static void grids_of_scattered_light_are_named(void **state)
{
    struct error error = message_of((struct job_quality){.method = JOB_METHOD_CACHED,
                                                         .step = 0.1,
                                                         .light_grid = 64,
                                                         .scatter_grid = 24,
                                                         .paths = 256,
                                                         .similar_after = 1});

    (void)state;
    assert_non_null(strstr(error.message, "by cached, step 0.1, light_grid 64, scatter_grid 24, paths 256, "
                                          "similar_after 1; "));
    error = message_of((struct job_quality){.method = JOB_METHOD_EQUIANGULAR,
                                            .points = 8,
                                            .scatter_grid = 24,
                                            .scatter_from = JOB_SCATTER_FROM_LIGHTS,
                                            .paths = 1048576});
    assert_non_null(
        strstr(error.message, "by equiangular, points 8, scatter_grid 24, paths 1048576, scatter_from lights; "));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_of_pixels_and_grids_of_lights_are_named),
        cmocka_unit_test(grids_of_scattered_light_are_named),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
