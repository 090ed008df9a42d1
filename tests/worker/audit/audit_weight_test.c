// Sums over rows are those of the pixels' weights, and a pixel that stands out has the weight of its distance.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/assert_near.h"
#include "worker/audit/audit_weight.h"
#include "worker/picture/image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static struct image make_image(int width_px, int height_px)
{
    struct image image;
    uint32_t state = 7;

    assert_true(image_init(&image, width_px, height_px, false, false, NULL));
    for (size_t i = 0; i < 4 * (size_t)width_px * (size_t)height_px; i++) {
        state = state * 1664525u + 1013904223u;
        image.rgba[i] = (float)(state >> 8) * 0x1p-20f;
    }
    return image;
}

static void rows_are_sums_of_pixels(void **state)
{
    static const int sizes[][2] = {{1, 1}, {3, 9}, {4, 4}, {5, 5}, {67, 7}, {200, 6}, {129, 5}};

    (void)state;
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        struct image image = make_image(sizes[k][0], sizes[k][1]);

        for (int y = 0; y < image.height_px; y++) {
            struct audit_weight_row row = audit_weight_row(&image, y);
            double squares = 0.0, spikes = 0.0;
            float brightest = 0.0f;

            for (int x = 0; x < image.width_px; x++) {
                size_t at = (size_t)y * (size_t)image.width_px + (size_t)x;

                squares += audit_weight_square(&image, at);
                spikes += audit_weight_spike(&image, at);
                for (size_t c = 0; c < 3; c++)
                    if (image.rgba[4 * at + c] > brightest) brightest = image.rgba[4 * at + c];
            }
            assert_near(row.squares, squares, 1e-5 * squares);
            assert_near(row.spikes, spikes, 1e-5 * spikes);
            assert_near(row.brightest, brightest, 0.0);
        }
        image_finish(&image);
    }
}

// One red pixel 0.5 above its even surroundings; pixels two away see it within their range.
static void a_spike_has_its_height(void **state)
{
    struct image image = make_image(20, 9);

    (void)state;
    for (size_t i = 0; i < 4 * 20 * 9; i++)
        image.rgba[i] = 0.25f;
    image.rgba[4 * (4 * 20 + 10)] = 0.75f;
    for (int y = 0; y < 9; y++)
        assert_near(audit_weight_row(&image, y).spikes, y == 4 ? 0.25 / 3.0 : 0.0, 1e-7);
    assert_near(audit_weight_spike(&image, 4 * 20 + 10), 0.25 / 3.0, 1e-7);
    image_finish(&image);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_sums_of_pixels),
        cmocka_unit_test(a_spike_has_its_height),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
