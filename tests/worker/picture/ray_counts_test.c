// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/ray_counts.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const struct job_quality quality = {.max_depth = 3, .min_throughput = 0.001, .max_cut = 0.01};

// Makes a picture that is black except for pixel (1, 0), whose green is `brightest`.
static struct image make_image(float brightest)
{
    struct image image;

    assert_true(image_init(&image, 4, 2, false, false, NULL));
    memset(image.rgba, 0, sizeof(float) * 4 * 8);
    image.rgba[4 + 1] = brightest;
    for (int i = 0; i < 8; ++i)
        image.rgba[4 * i + 3] = 1e6f; // alpha is no light
    return image;
}

static double share_of(double cut_throughput, float brightest)
{
    struct ray_counts counts = {.is_known = true, .cut_throughput = cut_throughput};
    struct image image = make_image(brightest);

    ray_counts_find_share(&counts, &image);
    image_finish(&image);
    return counts.cut_share;
}

static void means_are_over_pixels_and_samples(void **state)
{
    static const float rows[2][4 * 3] = {{0.5f, 1, 5, 0.25f, 0, 0, 2, 0, 0, 0, 2, 0},
                                         {0, 0, 2, 0, 1.5f, 7, 3, 0.25f, 0, 0, 40, 0}};
    struct ray_counts counts = {.is_known = true};

    for (int y = 0; y < 2; ++y)
        ray_counts_add_row(&counts, rows[y], 3, y);
    ray_counts_find_means(&counts, 6, 2);
    assert_near(counts.cut_throughput, 2.0 / 12, 1e-15);
    assert_near(counts.cut_rays, 8.0 / 12, 1e-15);
    assert_near(counts.rays, 54.0 / 12, 1e-15);
    assert_near(counts.cut_by_depth, 0.5 / 12, 1e-15);
    assert_near(counts.most_cut.value, 0.75, 0);
    assert_int_equal(counts.most_cut.x_px, 1);
    assert_int_equal(counts.most_cut.y_px, 1);
    assert_near(counts.most_rays.value, 20, 0);
    assert_int_equal(counts.most_rays.x_px, 2);
    assert_int_equal(counts.most_rays.y_px, 1);
}

static void share_is_what_the_brightest_value_would_have_added(void **state)
{
    // One of 24 values is not black, so the brightest is 24 means.
    assert_near(share_of(0.001, 8), 0.024, 1e-15);
    assert_near(share_of(0.001, 0.125f), 0.024, 1e-15);
    assert_near(share_of(0, 8), 0, 0);
}

static void share_of_a_black_picture_is_the_throughput(void **state)
{
    assert_near(share_of(0.3, 0), 0.3, 0);
}

static void share_is_no_more_than_all(void **state)
{
    assert_near(share_of(0.5, 1), 1, 0);
    assert_near(share_of(3, 0), 1, 0);
}

static void assert_refused(double share, double by_depth, const char *reason)
{
    const struct ray_counts counts = {.is_known = true,
                                      .cut_throughput = 0.5,
                                      .cut_by_depth = by_depth,
                                      .cut_share = share,
                                      .most_cut = {.value = 1, .x_px = 7, .y_px = 9}};
    struct error error = {0};

    assert_false(ray_counts_check(&counts, &quality, &error));
    if (!strstr(error.message, reason)) fail_msg("expected \"%s\" in \"%s\"", reason, error.message);
}

static void too_large_a_share_is_refused_with_what_helps(void **state)
{
    assert_refused(
        0.04, 0.375,
        "quality: cut rays may have taken 4 % of the light, max_cut allows 1 %; max_depth 3 cut 3 %, "
        "min_throughput 0.001 cut 1 %, most at pixel (7, 9); expected a larger max_depth, or a max_cut above "
        "0.04");
    assert_refused(1, 0.375, "expected a larger max_depth and a smaller min_throughput, or a max_cut of 1");
    assert_refused(0.04, 0.05, "expected a smaller min_throughput, or");
    assert_refused(0.04, 0.25, "expected a larger max_depth and a smaller min_throughput, or");
    // Neither part is too large by itself.
    assert_refused(0.012, 0.375, "expected a larger max_depth, or");
    assert_refused(0.012, 0.125, "expected a smaller min_throughput, or");
}

static void share_within_the_limit_passes(void **state)
{
    const struct ray_counts most = {.is_known = true, .cut_throughput = 0.001, .cut_share = 0.01};
    const struct ray_counts unknown = {.cut_share = 1};

    assert_true(ray_counts_check(&most, &quality, NULL));
    assert_true(ray_counts_check(&unknown, &quality, NULL));
}

static void share_that_is_no_number_is_refused(void **state)
{
    const struct job_quality all = {.max_depth = 3, .min_throughput = 0.001, .max_cut = 1};
    const float paths[4] = {NAN, 1, 1, 0};
    struct ray_counts counts = {.is_known = true};
    struct image image = make_image(1);

    ray_counts_add_row(&counts, paths, 1, 0);
    ray_counts_find_means(&counts, 1, 1);
    ray_counts_find_share(&counts, &image);
    assert_false(ray_counts_check(&counts, &all, NULL));
    image_finish(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(means_are_over_pixels_and_samples),
        cmocka_unit_test(share_is_what_the_brightest_value_would_have_added),
        cmocka_unit_test(share_of_a_black_picture_is_the_throughput),
        cmocka_unit_test(share_is_no_more_than_all),
        cmocka_unit_test(too_large_a_share_is_refused_with_what_helps),
        cmocka_unit_test(share_within_the_limit_passes),
        cmocka_unit_test(share_that_is_no_number_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
