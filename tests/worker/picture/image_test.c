// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image.h"

#include "core/base/error.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 5, HEIGHT_PX = 4 };

static struct image make_image(void)
{
    struct image image;

    assert_true(image_init(&image, WIDTH_PX, HEIGHT_PX, true, true, NULL));
    for (size_t i = 0; i < (size_t)4 * WIDTH_PX * HEIGHT_PX; i++)
        image.rgba[i] = image.transmittance[i] = 0.5f;
    for (size_t i = 0; i < (size_t)WIDTH_PX * HEIGHT_PX; i++)
        image.depth[i] = 2.0f;
    return image;
}

static void not_a_number_is_named_with_channel_and_pixel(void **state)
{
    struct image image = make_image();
    struct error error = {0};

    assert_true(image_is_finite(&image, true, &error));
    image.depth[7] = NAN;
    assert_false(image_is_finite(&image, true, &error));
    assert_non_null(strstr(error.message, "channel Z at pixel (2, 1) is NaN"));
    image.transmittance[19 * 4 + 2] = -INFINITY;
    assert_false(image_is_finite(&image, true, &error));
    assert_non_null(strstr(error.message, "channel transmittance.B at pixel (4, 3) is infinite"));
    image_finish(&image);
}

static void values_that_no_file_should_hold_are_counted(void **state)
{
    struct image image = make_image();
    struct error error = {0};

    image.rgba[2 * 4 + 1] = 7e4f;
    image.rgba[2 * 4 + 3] = NAN;
    image.rgba[17 * 4] = NAN;
    image.transmittance[3 * 4 + 3] = NAN; // belongs to no channel
    image.transmittance[3 * 4 + 2] = -7e4f;
    image.depth[19] = INFINITY;
    image.depth[0] = 7e4f; // never written as half
    assert_false(image_is_finite(&image, true, &error));
    assert_string_equal(error.message, "channel G at pixel (2, 0) is 70000: half holds at most 65504, ask for "
                                       "\"pixel\": \"float\"; of the frame's values 2 are NaN, 1 infinite, 2 too "
                                       "large for half");
    assert_false(image_is_finite(&image, false, &error));
    assert_string_equal(error.message, "channel A at pixel (2, 0) is NaN: expected a finite number; of the frame's "
                                       "values 2 are NaN, 1 infinite, 0 too large for half");
    image_finish(&image);
}

static void absurd_size_is_refused(void **state)
{
    struct image image;
    struct error error = {0};

    assert_false(image_init(&image, 16385, 1, false, false, &error));
    assert_non_null(strstr(error.message, "16385 x 1"));
    assert_false(image_init(&image, 0, 1, false, false, &error));
    assert_null(image.rgba);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(not_a_number_is_named_with_channel_and_pixel),
        cmocka_unit_test(values_that_no_file_should_hold_are_counted),
        cmocka_unit_test(absurd_size_is_refused),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
