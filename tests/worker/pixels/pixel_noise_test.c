// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_noise.h"

#include "core/base/alloc.h"
#include "tests/support/assert_near.h"
#include "worker/picture/image.h"
#include "worker/pixels/pixel_lattice.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 256, HEIGHT = 192, STRIDE = 8 };

// Channel 0 of a row of six: the root mean square of up to five values.
static void neighbours_share_their_noise(void **state)
{
    float plane[24] = {3, 0, 0, 7, -1, 0, 0, 7, 1, 0, 0, 7, 5, 0, 2, 7, 0, 0, 0, 7, 2, 0, 0, 7};

    (void)state;
    pixel_noise_pool(plane, 6, 1);
    assert_near(plane[0], sqrt(11 / 3.0), 1e-6);
    assert_near(plane[4], sqrt(36 / 4.0), 1e-6);
    assert_near(plane[8], sqrt(36 / 5.0), 1e-6);
    assert_near(plane[12], sqrt(31 / 5.0), 1e-6);
    assert_near(plane[20], sqrt(29 / 3.0), 1e-6);
    assert_near(plane[14], sqrt(4 / 5.0), 1e-6);
    assert_near(plane[3], 7, 0);
}

static void rows_share_their_noise(void **state)
{
    float plane[16] = {1, 1, 1, 0, 2, 1, 1, 0, 4, 1, 1, 0, 5, 1, 1, 0};

    (void)state;
    pixel_noise_pool(plane, 1, 4);
    assert_near(plane[0], sqrt(21 / 3.0), 1e-6);
    assert_near(plane[4], sqrt(46 / 4.0), 1e-6);
    assert_near(plane[12], sqrt(45 / 3.0), 1e-6);
    assert_near(plane[5], 1, 1e-6);
}

// A bend of 5 * 0.306 standard deviations, and the largest channel counts.
static void noise_explains_small_doubts(void **state)
{
    const float noise[16] = {0.1f, 1, 0.2f, 9, 1, 0, 0, 9, 0, 0, 1, 9, 0, 0, 0, 9};
    float doubt[4] = {3.0f, 3.1f, 0.5f, 1.01f};

    (void)state;
    pixel_noise_lower(noise, 2, 4, doubt);
    assert_near(doubt[0], 1, 0);
    assert_near(doubt[1], 3.1f, 0);
    assert_near(doubt[2], 0.5, 0);
    assert_near(doubt[3], 1.01f, 0);
    assert_true(pixel_noise_explains(noise, 6.3f));
    assert_false(pixel_noise_explains(noise, 6.5f));
}

struct picture {
    double noise; // standard deviation, over a light of 1 and, from `edge` on, 2
    int edge;     // px
};

// Sum of uniform numbers: nearly normal, mean 0, variance 1.
static float draw(void)
{
    double sum = 0;

    for (int i = 0; i < 12; i++)
        sum += (double)rand() / RAND_MAX;
    return (float)(sum - 6);
}

static void trace(struct pixel_lattice *lattice, const struct picture *picture)
{
    const struct pixel_channels channels = {.has_transmittance = true};
    struct pixel_planes planes;

    if (lattice->wanted_count == 0) return;
    pixel_planes_init(&planes, channels, lattice->wanted_count);
    for (size_t i = 0; i < lattice->wanted_count; i++) {
        float noise = (float)picture->noise, light = lattice->wanted[i].x < picture->edge ? 1 : 2;
        float value = light + noise * draw(), half = noise * draw();

        for (size_t c = 0; c < 4; c++)
            planes.rgba[4 * i + c] = value, planes.transmittance[4 * i + c] = half;
        planes.signatures[i] = 1;
    }
    pixel_lattice_give(lattice, &planes);
    pixel_planes_finish(&planes);
}

// The share of pixels that were traced. `lack` is the relative RMSE.
static double make(const struct picture *picture, bool has_noise, double *lack)
{
    struct image image = {0};
    struct pixel_lattice lattice;
    double traced, sum = 0;

    srand(7);
    assert_true(image_init(&image, WIDTH, HEIGHT, false, true, NULL));
    pixel_lattice_init(&lattice, &(struct pixel_lattice_params){
                                     .image = &image, .stride = STRIDE, .threshold = 0.01, .has_noise = has_noise});
    do
        trace(&lattice, picture);
    while (pixel_lattice_refine(&lattice));
    traced = (double)lattice.traced / (WIDTH * HEIGHT);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double light = i % WIDTH < picture->edge ? 1 : 2, off = (double)image.rgba[4 * (size_t)i] - light;

        sum += off * off / (light * light);
    }
    *lack = sqrt(sum / (WIDTH * HEIGHT));
    pixel_lattice_finish(&lattice);
    image_finish(&image);
    print_message("noise %g, edge at %d, %s: %.1f %% traced, lacks %.3f\n", picture->noise, picture->edge,
                  has_noise ? "known" : "unknown", 100 * traced, *lack);
    return traced;
}

static void known_noise_asks_for_no_pixels(void **state)
{
    const struct picture flat = {.noise = 0.05, .edge = 2 * WIDTH};
    double lack, first = 1.0 / (STRIDE * STRIDE);

    (void)state;
    assert_true(make(&flat, false, &lack) > 0.5);
    assert_true(make(&flat, true, &lack) < 1.1 * first);
    // Interpolation averages what is left of it.
    assert_true(lack < 0.85 * flat.noise);
}

static void an_edge_in_known_noise_is_found(void **state)
{
    const struct picture edge = {.noise = 0.05, .edge = 101};
    double lack, traced = make(&edge, true, &lack);

    (void)state;
    assert_true(traced < 0.2);
    assert_true(lack < 0.06);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(neighbours_share_their_noise),    cmocka_unit_test(rows_share_their_noise),
        cmocka_unit_test(noise_explains_small_doubts),     cmocka_unit_test(known_noise_asks_for_no_pixels),
        cmocka_unit_test(an_edge_in_known_noise_is_found),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
