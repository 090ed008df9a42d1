// The midpoint method on jobs/cloud.json against the converged integral.
// SPDX-License-Identifier: Apache-2.0
#include "reference/reference.h"
#include "tests/support/example_job.h"
#include "tests/support/render_frame.h"
#include "worker/picture/image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { WIDTH_PX = 48, HEIGHT_PX = 27, PIXELS = WIDTH_PX * HEIGHT_PX };

static void compare(double time)
{
    static float radiance[3 * PIXELS], transmittance[3 * PIXELS], alpha[PIXELS];
    static double true_radiance[3 * PIXELS], true_transmittance[3 * PIXELS], true_alpha[PIXELS];
    struct reference_error of_radiance, of_transmittance, of_alpha;
    struct still still;
    struct image image;
    struct job job;

    example_job_load(&job, "cloud");
    example_job_shrink(&job, WIDTH_PX, HEIGHT_PX, time);
    job.output.has_depth = job.output.has_transmittance = true;
    render_frame_zero(&job, &image);
    still_init(&still, &job, time);
    job_finish(&job);
    for (int i = 0; i < PIXELS; i++) {
        // An accuracy of 1e-3, ten times coarser than the default, is still ten times finer than the tolerance.
        struct reference_pixel pixel =
            reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX, &(struct integrate_accuracy){.relative = 1e-3});

        for (int c = 0; c < 3; c++) {
            radiance[3 * i + c] = image.rgba[4 * i + c];
            transmittance[3 * i + c] = image.transmittance[4 * i + c];
            true_radiance[3 * i + c] = pixel.radiance[c];
            true_transmittance[3 * i + c] = pixel.transmittance[c];
        }
        alpha[i] = image.rgba[4 * i + 3];
        true_alpha[i] = pixel.alpha;
    }
    image_finish(&image);
    of_radiance = reference_image_error(radiance, true_radiance, 3 * PIXELS);
    of_transmittance = reference_image_error(transmittance, true_transmittance, 3 * PIXELS);
    of_alpha = reference_image_error(alpha, true_alpha, PIXELS);
    print_message("t = %.1f: relative RMSE of radiance %.2e (largest %.2e), transmittance %.2e, alpha %.2e\n", time,
                  of_radiance.relative_rmse, of_radiance.largest, of_transmittance.relative_rmse,
                  of_alpha.relative_rmse);
    // The method's goal at the job's steps: one per cent.
    assert_true(of_radiance.relative_rmse <= 0.01);
    assert_true(of_transmittance.relative_rmse <= 0.01);
    assert_true(of_alpha.relative_rmse <= 0.01);
}

static void midpoint_is_within_a_percent_at_2_s(void **state)
{
    compare(2.0);
}

static void midpoint_is_within_a_percent_at_5_7_s(void **state)
{
    compare(5.7);
}

// Depth of an opaque cloud is sharp: half of the light is lost within a few steps.
static void depth_is_within_a_step(void **state)
{
    struct still still;
    struct image image;
    struct job job;
    int opaque = 0;

    example_job_load(&job, "cloud");
    example_job_shrink(&job, WIDTH_PX, HEIGHT_PX, 2.0);
    job.output.has_depth = job.output.has_transmittance = true;
    render_frame_zero(&job, &image);
    still_init(&still, &job, 2.0);
    for (int i = 0; i < PIXELS; i++) {
        double depth = reference_measure_depth(&still, i % WIDTH_PX, i / WIDTH_PX);
        double mean = (double)image.transmittance[4 * i];

        // Rounding decides whether there is a depth where transmittance is about a half.
        if (mean > 0.45 && mean < 0.55) continue;
        opaque += depth > 0.0;
        assert_true(image.depth[i] >= depth - job.quality.step && image.depth[i] <= depth + job.quality.step);
    }
    assert_true(opaque > PIXELS / 20);
    job_finish(&job);
    image_finish(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(midpoint_is_within_a_percent_at_2_s),
        cmocka_unit_test(midpoint_is_within_a_percent_at_5_7_s),
        cmocka_unit_test(depth_is_within_a_step),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
