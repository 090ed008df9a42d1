// Lists are laid out so that each pixel is drawn, and processors have work.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "worker/render/pixel_layout.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct pixel *make_list(size_t count)
{
    struct pixel *pixels = xcalloc(count, sizeof *pixels);

    for (size_t i = 0; i < count; i++)
        pixels[i] = (struct pixel){(int)(i * 7919 % 16384), (int)(i * 104729 % 16384)};
    return pixels;
}

// Each pixel has a place in a square, and what is gathered from the places is the list.
static void every_pixel_is_drawn(void **state)
{
    static const size_t counts[] = {1, 15, 16, 17, 100, 4095, 4096, 30000, 100001};

    (void)state;
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        struct pixel *pixels = make_list(counts[k]);
        struct pixel_layout layout;
        float *target, *list = xcalloc(2 * counts[k], sizeof *list);

        pixel_layout_init(&layout, pixels, counts[k], 3);
        target = xcalloc(2 * (size_t)layout.width_px * (size_t)layout.height_px, sizeof *target);
        for (int square = 0; square < layout.square_count; square++) {
            struct pixel corner = pixel_layout_square(&layout, square);

            assert_true(corner.x + layout.side <= layout.width_px && corner.y + layout.side <= layout.height_px);
            for (int i = 0; i < layout.side * layout.side; i++) {
                int x = i % layout.side, y = i / layout.side;
                struct pixel pixel = pixels[pixel_layout_index(&layout, square, x, y)];
                size_t at = (size_t)(corner.y + y) * (size_t)layout.width_px + (size_t)(corner.x + x);

                target[2 * at] = (float)pixel.x;
                target[2 * at + 1] = (float)pixel.y;
            }
        }
        for (int strip = 0; strip < pixel_layout_strip_count(&layout); strip++) {
            size_t first = (size_t)pixel_layout_strip_y(strip) * (size_t)layout.width_px;

            pixel_layout_gather(&layout, strip, target + 2 * first, 2 * sizeof *target, list);
        }
        for (size_t i = 0; i < counts[k]; i++)
            assert_true(list[2 * i] == (float)pixels[i].x && list[2 * i + 1] == (float)pixels[i].y);
        free(list);
        free(target);
        pixel_layout_finish(&layout);
        free(pixels);
    }
}

// Software GL gives each thread squares of the target.
static void short_lists_are_for_all_threads(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 16; threads *= 2) {
        for (size_t count = 16 * (size_t)threads; count <= 4096; count *= 2) {
            struct pixel *pixels = make_list(count);
            struct pixel_layout layout;

            pixel_layout_init(&layout, pixels, count, threads);
            assert_true(layout.square_count >= threads);
            pixel_layout_finish(&layout);
            free(pixels);
        }
    }
}

// A square of a whole frame's list shows a square of the frame.
static void neighbours_stay_together(void **state)
{
    enum { SIDE = 128 };
    struct pixel *pixels = xcalloc(SIDE * SIDE, sizeof *pixels);
    struct pixel_layout layout;

    (void)state;
    for (int i = 0; i < SIDE * SIDE; i++)
        pixels[i] = (struct pixel){i % SIDE, i / SIDE};
    pixel_layout_init(&layout, pixels, SIDE * SIDE, 1);
    assert_int_equal(layout.side, 64);
    for (int square = 0; square < layout.square_count; square++) {
        struct pixel first = pixels[pixel_layout_index(&layout, square, 0, 0)];

        for (int i = 0; i < 64 * 64; i++) {
            struct pixel pixel = pixels[pixel_layout_index(&layout, square, i % 64, i / 64)];

            assert_int_equal(pixel.x, first.x + i % 64);
            assert_int_equal(pixel.y, first.y + i / 64);
        }
    }
    pixel_layout_finish(&layout);
    free(pixels);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pixel_is_drawn),
        cmocka_unit_test(short_lists_are_for_all_threads),
        cmocka_unit_test(neighbours_stay_together),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
