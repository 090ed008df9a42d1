// SPDX-License-Identifier: Apache-2.0
#include "worker/textures/dome_table.h"

#include "core/base/alloc.h"
#include "reference/dome.h"
#include "reference/dome_sampler.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static void make_image(struct image *image, int width_px, int height_px)
{
    struct random random = {51};

    assert_true(image_init(image, width_px, height_px, false, false, NULL));
    for (size_t i = 0; i < 4 * (size_t)width_px * (size_t)height_px; i++)
        image->rgba[i] = (float)random_between(&random, 0.0, 1.0);
    image->rgba[4 * (size_t)(width_px / 2) + 1] = 1e5F; // a sun next to the pole
}

// The share of draws of a texel of the table's row: its own, and what others lend it.
static double share_of(const struct image *table, int row, int count, int wanted)
{
    double share = 0.0;

    for (int i = 0; i < count; i++) {
        const float *entry = &table->rgba[4 * ((size_t)row * (size_t)table->width_px + (size_t)i)];

        if (i == wanted) share += (double)entry[0];
        if ((int)entry[1] == wanted) share += 1.0 - (double)entry[0];
    }
    return share / count;
}

static void assert_draws_are_by_density(int width_px, int height_px)
{
    struct image image, table;
    double sum = 0.0;

    make_image(&image, width_px, height_px);
    assert_true(dome_table_init(&table, &image, NULL));
    for (int row = 0; row < height_px; row++) {
        double angle = 2.0 * M_PI / width_px *
                       (sin(M_PI * (0.5 - (double)row / height_px)) - sin(M_PI * (0.5 - (row + 1.0) / height_px)));

        for (int column = 0; column < width_px; column++) {
            const float *entry = &table.rgba[4 * ((size_t)row * (size_t)table.width_px + (size_t)column)];
            double share = share_of(&table, height_px, height_px, row) * share_of(&table, row, width_px, column);

            // Shares that are lent are differences from 1, and a texel may have many.
            assert_near(share, (double)entry[2] * angle, 1e-6 * share + 2e-7 / height_px);
            sum += (double)entry[2] * angle;
        }
    }
    assert_near(sum, 1.0, 1e-5);
    image_finish(&table);
    image_finish(&image);
}

static void draws_are_by_density_whatever_the_shape(void **state)
{
    assert_draws_are_by_density(16, 8);
    assert_draws_are_by_density(7, 11);
    assert_draws_are_by_density(1, 1);
    assert_draws_are_by_density(1, 5);
}

// The densities are those of the reference's own sampler, which finds them by sums.
static void densities_are_the_twins(void **state)
{
    enum { WIDTH = 24, HEIGHT = 12 };
    float rgb[HEIGHT * WIDTH * 3];
    struct dome dome = {.kind = SCENE_DOME_FILE,
                        .along = {1.0, 1.0, 1.0},
                        .axis = {0.0, 1.0, 0.0},
                        .rgb = rgb,
                        .width = WIDTH,
                        .height = HEIGHT};
    struct dome_sampler sampler;
    struct image image, table;

    make_image(&image, WIDTH, HEIGHT);
    for (size_t i = 0; i < sizeof rgb / sizeof *rgb; i++)
        rgb[i] = image.rgba[i / 3 * 4 + i % 3];
    dome_sampler_init(&sampler, &dome);
    assert_true(dome_table_init(&table, &image, NULL));
    for (int row = 0; row < HEIGHT; row++)
        for (int column = 0; column < WIDTH; column++) {
            double up = M_PI * (0.5 - (row + 0.5) / HEIGHT), turn = 2.0 * M_PI * (0.5 - (column + 0.5) / WIDTH);
            double wanted =
                dome_sampler_density(&sampler, (struct vec3){cos(up) * sin(turn), sin(up), cos(up) * cos(turn)});

            assert_near((double)table.rgba[4 * (row * WIDTH + column) + 2], wanted, 1e-6 * wanted);
        }
    dome_sampler_finish(&sampler);
    image_finish(&table);
    image_finish(&image);
}

static void black_image_is_drawn_evenly(void **state)
{
    struct image image, table;

    assert_true(image_init(&image, 6, 3, false, false, NULL));
    for (size_t i = 0; i < (size_t)4 * 6 * 3; i++)
        image.rgba[i] = 0.0F;
    assert_true(dome_table_init(&table, &image, NULL));
    for (int row = 0; row < 3; row++) {
        double height = sin(M_PI * (0.5 - row / 3.0)) - sin(M_PI * (0.5 - (row + 1.0) / 3.0));

        assert_near(share_of(&table, 3, 3, row), 0.5 * height, 1e-6);
        assert_near((double)table.rgba[4 * (size_t)(row * 6) + 2], 0.25 / M_PI, 1e-8);
        assert_near(share_of(&table, row, 6, 2), 1.0 / 6.0, 1e-6);
    }
    image_finish(&table);
    image_finish(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(draws_are_by_density_whatever_the_shape),
        cmocka_unit_test(densities_are_the_twins),
        cmocka_unit_test(black_image_is_drawn_evenly),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
