// The seed's cloud from jobs/cloud_seed.json against a transcription of the seed's formulas.
// SPDX-License-Identifier: Apache-2.0
// tests/mutations runs this program with broken shaders or jobs. MARCHD_TEST_SHADER_DIR overrides shader modules,
// MARCHD_TEST_JOB is the path of another job. Arguments: the picture's size in pixels, a pattern of the tests to run.
#include "core/base/error.h"
#include "reference/reference.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/seed_cloud.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static int size_px = 96;

static const double TIMES[] = {0.0, 2.0, 5.7, 9.9};
enum { TIME_COUNT = sizeof TIMES / sizeof TIMES[0] };

// Floats differ from doubles by less than 3e-5, including early stops that rounding moves. Mutations differ by over
// 1e-2.
static const double TOLERANCE = 1e-4;

static void render(struct renderer *renderer, double time, struct image *image)
{
    struct error error = {{0}};
    const char *path = getenv("MARCHD_TEST_JOB");
    struct renderer_result result;
    struct job job;

    if (path) {
        example_job_load_file(&job, path);
    } else {
        example_job_load(&job, "cloud_seed");
    }
    example_job_shrink(&job, size_px, size_px, time);
    if (!renderer_render(renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = image}, &result, &error))
        fail_msg("%s", error.message);
    job_finish(&job);
}

static void compare(enum gl_backend backend)
{
    struct error error = {{0}};
    struct gl_stage stage = gl_stage_open(backend, test_shader_dir());
    struct image image;
    size_t count = 3 * (size_t)size_px * (size_t)size_px;
    double *seed = malloc(sizeof *seed * count);
    float *rgb = malloc(sizeof *rgb * count);
    int failures = 0;

    assert_true(image_init(&image, size_px, size_px, false, false, &error));
    for (int i = 0; i < TIME_COUNT; i++) {
        struct reference_error difference;

        render(stage.renderer, TIMES[i], &image);
        seed_cloud_render(TIMES[i], size_px, seed);
        for (size_t k = 0; k < count; k++)
            rgb[k] = image.rgba[k / 3 * 4 + k % 3];
        difference = reference_image_error(rgb, seed, count);
        print_message("t = %.1f: relative RMSE %.2e, largest %.2e\n", TIMES[i], difference.relative_rmse,
                      difference.largest);
        failures += !(difference.relative_rmse <= TOLERANCE);
    }
    assert_int_equal(failures, 0);
    free(seed);
    free(rgb);
    image_finish(&image);
    gl_stage_close(stage);
}

static void software_renders_the_seed_cloud(void **state)
{
    compare(GL_BACKEND_SOFTWARE);
}

static void egl_renders_the_seed_cloud(void **state)
{
    compare(GL_BACKEND_EGL);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(software_renders_the_seed_cloud),
        cmocka_unit_test(egl_renders_the_seed_cloud),
    };

    if (argument_count > 1) size_px = atoi(arguments[1]);
    if (argument_count > 2) cmocka_set_test_filter(arguments[2]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
