// SPDX-License-Identifier: Apache-2.0
#include "reference/reference.h"

#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/example_job.h"
#include "tests/support/homogeneous.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { WIDTH_PX = 16, HEIGHT_PX = 9, PIXELS = WIDTH_PX * HEIGHT_PX };

static void cloud_at(struct still *still, double time)
{
    struct job job;

    example_job_load(&job, "cloud");
    example_job_shrink(&job, WIDTH_PX, HEIGHT_PX, 0.0);
    still_init(still, &job, time);
    job_finish(&job);
}

static struct reference_error difference_of(const struct still *still, double relative, double finer)
{
    float coarse_image[3 * PIXELS];
    double fine_image[3 * PIXELS];

    for (int i = 0; i < PIXELS; i++) {
        struct reference_pixel coarse = reference_measure_pixel(still, i % WIDTH_PX, i / WIDTH_PX,
                                                                &(struct integrate_accuracy){.relative = relative});
        struct reference_pixel fine =
            reference_measure_pixel(still, i % WIDTH_PX, i / WIDTH_PX, &(struct integrate_accuracy){.relative = finer});

        assert_true(coarse.is_converged && fine.is_converged);
        for (int c = 0; c < 3; c++) {
            coarse_image[3 * i + c] = (float)coarse.radiance[c];
            fine_image[3 * i + c] = fine.radiance[c];
        }
    }
    return reference_image_error(coarse_image, fine_image, 3 * PIXELS);
}

static void cloud_is_converged(void **state)
{
    static const double TIMES[] = {2.0, 5.7};
    struct still still;

    for (int i = 0; i < 2; i++) {
        struct reference_error difference;

        cloud_at(&still, TIMES[i]);
        difference = difference_of(&still, 1e-4, 1e-6);
        print_message("t = %.1f: 1e-4 against 1e-6: relative RMSE %.2e, largest %.2e\n", TIMES[i],
                      difference.relative_rmse, difference.largest);
        // 1e-4 is the accuracy promised; no pixel may be off by more than ten times that.
        assert_true(difference.relative_rmse <= 1e-4);
        assert_true(difference.largest <= 1e-3);
    }
}

// Radiance by plain midpoint sums with steps far below the cloud's folds: no spans, no Gauss, no refinement.
static double summed_radiance(const struct still *still, const struct ray *ray)
{
    const double step = 5e-4;
    const struct medium *medium = &still->media[0];
    const struct density_fold_fractal *fractal = &still->fields[0].fold_fractal;
    double radiance = 0.0, optical_depth = 0.0;

    for (double t = still->camera.clip_near + 0.5 * step; t < still->camera.clip_far; t += step) {
        struct vec3 point = ray_at(ray, t);
        double density = density_fold_fractal(fractal, point), shadow = 0.0;
        struct vec3 way = vec3_subtract(still->lights[0].position, point);
        double distance = vec3_length(way);
        long steps = lround(distance / step);

        if (density == 0.0) continue;
        for (long k = 0; k < steps; k++) {
            struct vec3 at = vec3_add(point, vec3_scale(way, ((double)k + 0.5) / (double)steps));

            shadow += density_fold_fractal(fractal, at) * distance / (double)steps;
        }
        optical_depth += 0.5 * medium->sigma_s[0] * density * step;
        radiance += exp(-optical_depth - medium->sigma_s[0] * shadow) * medium->sigma_s[0] * density * step *
                    medium_phase(medium, vec3_dot(way, ray->direction) / distance) * still->lights[0].intensity[0];
        optical_depth += 0.5 * medium->sigma_s[0] * density * step;
    }
    return radiance;
}

static void cloud_agrees_with_plain_sums(void **state)
{
    struct still still;
    int compared = 0;

    cloud_at(&still, 2.0);
    // Every second pixel is compared, if it shows the lit side.
    for (int i = 0; i < PIXELS; i += 2) {
        struct ray ray = camera_pinhole_ray(&still.camera, i % WIDTH_PX + 0.5, i / WIDTH_PX + 0.5);
        double radiance = reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX, NULL).radiance[0];

        if (radiance < 2e-3) continue;
        // Both are accurate to 1e-4: the sums have a step 300 times smaller than the cloud's radius, and are of second
        // order.
        assert_near(radiance, summed_radiance(&still, &ray), 1e-4 * radiance);
        compared++;
    }
    assert_true(compared >= 5);
}

static void fill(double color[static 3], double value)
{
    color[0] = color[1] = color[2] = value;
}

static void furnace_hides_a_medium_that_glows_as_it_absorbs(void **state)
{
    struct still still;

    cloud_at(&still, 2.0);
    fill(still.media[0].sigma_s, 0.0);
    fill(still.media[0].sigma_a, 64.0);
    fill(still.media[0].emission, 64.0);
    fill(still.background, 1.0);
    still.has_background = true;
    for (int i = 0; i < PIXELS; i++) {
        struct reference_pixel pixel = reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX, NULL);

        for (int c = 0; c < 3; c++)
            assert_near(pixel.radiance[c], 1.0, 1e-4); // the default accuracy
        assert_near(pixel.alpha, 1.0, 0.0);
    }
}

static void job_numbers_stand_for_all_channels(void **state)
{
    struct still still;

    cloud_at(&still, 2.0);
    for (int c = 0; c < 3; c++) {
        assert_near(still.media[0].sigma_s[c], 64.0, 0.0);
        assert_near(still.lights[0].intensity[c], 19.634954084936208, 0.0);
    }
    assert_near(still.lights[0].position.x, 1.5 * sin(3.1 * 0.4 + 0.2), 1e-15);
    assert_int_equal(still.media[0].lobe_count, 2);
    assert_near(still.fields[0].fold_fractal.sin_x, sin(-0.4), 1e-15);
}

// The camera stands at z = -3 before a slab of half a metre to either side of z = 0.
static struct still slab_still(const struct homogeneous_box *slab, double sigma_a)
{
    struct still still = {.medium_count = 1};

    camera_pinhole_init(&still.camera, &(struct camera_pinhole_params){.position = {0.0, 0.0, -3.0},
                                                                       .up = {0.0, 1.0, 0.0},
                                                                       .fov_deg = 60.0,
                                                                       .width_px = 3,
                                                                       .height_px = 3,
                                                                       .clip_far = INFINITY});
    still.media[0].density = homogeneous_box_density(slab);
    fill(still.media[0].sigma_a, sigma_a);
    return still;
}

static void alpha_is_what_the_media_hide(void **state)
{
    struct homogeneous_box slab = {INFINITY, INFINITY, 0.5};
    struct still still = slab_still(&slab, 1.0);
    struct reference_pixel pixel;

    still.media[0].sigma_a[0] = 2.0;
    pixel = reference_measure_pixel(&still, 1, 1, NULL);
    assert_near(pixel.alpha, 1.0 - (exp(-2.0) + 2.0 * exp(-1.0)) / 3.0, 1e-12);
}

static void depth_is_where_half_the_light_is_left(void **state)
{
    struct homogeneous_box slab = {INFINITY, INFINITY, 0.5};
    struct still still = slab_still(&slab, 2.0);
    struct ray corner = camera_pinhole_ray(&still.camera, 0.5, 0.5);

    // 1e-9: forty halvings of a few metres.
    assert_near(reference_measure_depth(&still, 1, 1), 2.5 + log(2.0) / 2.0, 1e-9);
    // The same distance along a slanted ray is less deep.
    assert_near(reference_measure_depth(&still, 0, 0), 2.5 + log(2.0) / 2.0 * corner.direction.z, 1e-9);
    fill(still.media[0].sigma_a, 0.5);
    assert_near(reference_measure_depth(&still, 1, 1), 0.0, 0.0);
}

static void image_error_is_relative_to_the_reference(void **state)
{
    static const float IMAGE[] = {1.0f, 2.0f, 3.5f};
    static const double TRUTH[] = {1.0, 2.0, 3.0};
    struct reference_error error = reference_image_error(IMAGE, TRUTH, 3);

    assert_near(error.relative_rmse, 0.5 / sqrt(14.0), 1e-15);
    assert_near(error.largest, 0.5, 0.0);
    assert_int_equal(error.largest_index, 2);
}

static void image_error_of_black_is_absolute(void **state)
{
    static const float IMAGE[] = {1e-3f, 0.0f};
    static const double TRUTH[] = {0.0, 9e-7};

    assert_near(reference_image_error(IMAGE, TRUTH, 2).relative_rmse, 1e-3 / sqrt(2.0), 1e-9);
}

static void image_error_of_a_nan_is_infinite(void **state)
{
    static const float IMAGE[] = {1.0f, NAN, 1.0f};
    static const double TRUTH[] = {1.0, 1.0, 1.0};
    struct reference_error error = reference_image_error(IMAGE, TRUTH, 3);

    assert_true(isinf(error.relative_rmse) && isinf(error.largest));
    assert_int_equal(error.largest_index, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cloud_is_converged),
        cmocka_unit_test(cloud_agrees_with_plain_sums),
        cmocka_unit_test(furnace_hides_a_medium_that_glows_as_it_absorbs),
        cmocka_unit_test(job_numbers_stand_for_all_channels),
        cmocka_unit_test(alpha_is_what_the_media_hide),
        cmocka_unit_test(depth_is_where_half_the_light_is_left),
        cmocka_unit_test(image_error_is_relative_to_the_reference),
        cmocka_unit_test(image_error_of_black_is_absolute),
        cmocka_unit_test(image_error_of_a_nan_is_infinite),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
