// What a plan leaves for the audits of its frames, of pixels whose errors are known.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_evidence.h"

#include "worker/audit/audit.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/picture/pixel.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { WIDTH_PX = 4, HEIGHT_PX = 2, PIXELS = WIDTH_PX * HEIGHT_PX, POINTS = 3 };

// A picture of 2 everywhere, whose light is known at three points: in two halves, 1.9 +- 0.05.
static struct audit_pool pool_of(float brightness)
{
    static const struct pixel points[POINTS] = {{0, 0}, {3, 0}, {2, 1}};
    struct truth_pixel light[POINTS] = {{.rgb = {0}}};
    struct audit_pool pool = {0};
    struct image image;

    assert_true(image_init(&image, WIDTH_PX, HEIGHT_PX, false, false, NULL));
    for (int i = 0; i < 4 * PIXELS; i++)
        image.rgba[i] = brightness;
    for (int i = 0; i < POINTS; i++)
        for (int c = 0; c < 3; c++) {
            light[i].rgb[c] = 1.9;
            light[i].half[c] = 0.05;
        }
    scatter_evidence_add(&image, points, light, POINTS, JOB_PIXEL_FLOAT, &pool);
    image_finish(&image);
    return pool;
}

static void the_lights_noise_counts_nothing(void **state)
{
    struct audit_pool pool = pool_of(2.0f);

    (void)state;
    assert_int_equal(pool.samples.count, POINTS);
    for (size_t i = 0; i < POINTS; i++) {
        assert_float_equal(pool.samples.list[i].square, (0.1 * 0.1 - 0.05 * 0.05) / 4.0, 1e-9);
        assert_float_equal(pool.samples.list[i].cross, 2.0 * 0.1 / 4.0, 1e-9);
        assert_true(pool.samples.list[i].noise == 0.0);
    }
    audit_pool_finish(&pool);
}

static void a_black_picture_says_nothing(void **state)
{
    struct audit_pool pool = pool_of(0.0f);

    (void)state;
    assert_int_equal(pool.samples.count, 0);
    audit_pool_finish(&pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_lights_noise_counts_nothing),
        cmocka_unit_test(a_black_picture_says_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
