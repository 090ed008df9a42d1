// SPDX-License-Identifier: Apache-2.0
#include "reference/dome.h"

#include "reference/dome_sampler.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 16, HEIGHT = 8 };

static float image[HEIGHT][WIDTH][3];

static const struct vec3 X = {1.0, 0.0, 0.0}, Y = {0.0, 1.0, 0.0}, Z = {0.0, 0.0, 1.0};

static struct dome image_dome(void)
{
    memset(image, 0, sizeof image);
    return (struct dome){.kind = SCENE_DOME_FILE,
                         .along = {2.0, 3.0, 4.0},
                         .axis = Y,
                         .rgb = image[0][0],
                         .width = WIDTH,
                         .height = HEIGHT};
}

static double radiance_of(const struct dome *dome, struct vec3 toward, int channel)
{
    double radiance[3];

    dome_radiance(dome, toward, radiance);
    return radiance[channel];
}

static struct vec3 middle_of(int row, int column)
{
    double up = M_PI * (0.5 - (row + 0.5) / HEIGHT), turn = 2.0 * M_PI * (0.5 - (column + 0.5) / WIDTH);

    return (struct vec3){cos(up) * sin(turn), sin(up), cos(up) * cos(turn)};
}

static struct vec3 random_direction(struct random *random)
{
    double y = random_between(random, -1.0, 1.0), turn = random_between(random, 0.0, 2.0 * M_PI);

    return (struct vec3){sqrt(1.0 - y * y) * sin(turn), y, sqrt(1.0 - y * y) * cos(turn)};
}

static void even_dome_is_the_same_everywhere(void **state)
{
    struct dome dome = {.along = {1.0, 2.0, 3.0}};

    assert_near(radiance_of(&dome, X, 0), 1.0, 0.0);
    assert_near(radiance_of(&dome, Y, 1), 2.0, 0.0);
    assert_near(radiance_of(&dome, Z, 2), 3.0, 0.0);
}

static void gradient_is_linear_in_the_cosine(void **state)
{
    struct dome dome = {.kind = SCENE_DOME_GRADIENT, .along = {1.0, 2.0, 3.0}, .against = {5.0, 0.0, 3.0}, .axis = Z};
    struct vec3 between = {sqrt(0.75), 0.0, 0.5};

    assert_near(radiance_of(&dome, Z, 0), 1.0, 1e-15);
    assert_near(radiance_of(&dome, vec3_scale(Z, -1.0), 0), 5.0, 1e-15);
    assert_near(radiance_of(&dome, X, 0), 3.0, 1e-15);
    assert_near(radiance_of(&dome, between, 0), 2.0, 1e-15);
    assert_near(radiance_of(&dome, between, 1), 1.5, 1e-15);
    assert_near(radiance_of(&dome, between, 2), 3.0, 1e-15);
}

static void image_lies_as_the_format_says(void **state)
{
    struct dome dome = image_dome();

    image[2][11][0] = 1.0F;
    image[7][0][1] = 1.0F;
    image[0][15][2] = 1.0F;
    assert_near(radiance_of(&dome, middle_of(2, 11), 0), 2.0, 1e-14);
    assert_near(radiance_of(&dome, middle_of(7, 0), 1), 3.0, 1e-14);
    assert_near(radiance_of(&dome, middle_of(0, 15), 2), 4.0, 1e-14);
    assert_near(radiance_of(&dome, middle_of(2, 12), 0), 0.0, 1e-14);
}

static void image_is_bilinear_and_goes_around(void **state)
{
    struct dome dome = image_dome();
    struct vec3 back = vec3_scale(Z, -1.0);
    double up = M_PI / 16.0; // the middle of row 3

    image[3][0][0] = 1.0F;
    image[3][15][0] = 3.0F;
    // On the border, halfway between the last column and the first; halfway down to an empty row.
    assert_near(radiance_of(&dome, (struct vec3){0.0, sin(up), -cos(up)}, 0), 2.0 * 2.0, 1e-14);
    assert_near(radiance_of(&dome, back, 0), 2.0, 1e-14);
}

static void first_row_reaches_to_the_pole(void **state)
{
    struct dome dome = image_dome();

    for (int i = 0; i < WIDTH; i++)
        image[0][i][0] = 1.0F;
    assert_near(radiance_of(&dome, Y, 0), 2.0, 1e-14);
    assert_near(radiance_of(&dome, vec3_scale(Y, -1.0), 0), 0.0, 1e-14);
}

static void image_is_turned_about_the_axis(void **state)
{
    struct dome dome = image_dome();

    image[3][4][0] = image[4][4][0] = image[3][3][0] = image[4][3][0] = 1.0F; // towards x
    assert_near(radiance_of(&dome, X, 0), 2.0, 1e-14);
    dome.angle = M_PI / 2.0; // about y: x goes to -z
    assert_near(radiance_of(&dome, vec3_scale(Z, -1.0), 0), 2.0, 1e-14);
    assert_near(radiance_of(&dome, X, 0), 0.0, 1e-14);
    dome.axis = Z; // about z: x goes to y
    assert_near(radiance_of(&dome, Y, 0), 2.0, 1e-12);
}

static void fill_with_a_sun(struct dome *dome)
{
    *dome = image_dome();
    for (int row = 0; row < HEIGHT; row++)
        for (int column = 0; column < WIDTH; column++)
            for (int c = 0; c < 3; c++)
                image[row][column][c] = (float)(1 + (row + 3 * column + c) % 5);
    image[1][5][0] = image[1][5][1] = image[1][5][2] = 1e5F;
    dome->axis = vec3_normalize((struct vec3){1.0, 2.0, -0.5});
    dome->angle = 1.1;
}

// The density of drawn directions integrates to 1 over the sphere, the mean of radiance over density is the integral of
// the radiance, whose standard deviation the draws give, and the mean density of draws is the integral of its square.
static void assert_draws_fit(const struct dome *dome, double most_variation)
{
    enum { DRAWS = 400000 };
    struct dome_sampler sampler;
    struct random random = {31};
    double even = 0.0, even_squares = 0.0, sum = 0.0, squares = 0.0, whole = 0.0, mean, error;
    double drawn = 0.0, whole_squares = 0.0;

    dome_sampler_init(&sampler, dome);
    for (int i = 0; i < DRAWS; i++) {
        double u[4], value, density;
        struct vec3 toward = random_direction(&random);

        density = dome_sampler_density(&sampler, toward) * 4.0 * M_PI;
        whole += density;
        whole_squares += density * density;
        value = radiance_of(dome, toward, 1) * 4.0 * M_PI;
        even += value;
        even_squares += value * value;
        for (int k = 0; k < 4; k++)
            u[k] = random_between(&random, 0.0, 1.0);
        toward = dome_sampler_draw(&sampler, u);
        assert_near(vec3_length(toward), 1.0, 1e-12);
        density = dome_sampler_density(&sampler, toward);
        drawn += density * 4.0 * M_PI;
        value = radiance_of(dome, toward, 1) / density;
        sum += value;
        squares += value * value;
    }
    dome_sampler_finish(&sampler);
    mean = sum / DRAWS;
    assert_true(squares / DRAWS - mean * mean < most_variation * most_variation * mean * mean);
    even /= DRAWS;
    error = sqrt(fmax(even_squares / DRAWS - even * even + squares / DRAWS - mean * mean, 0.0) / DRAWS);
    assert_near(mean, even, 4.0 * error + 1e-9 * mean);
    // Density is 1e5 in a 128th of the sphere at most: its own standard deviation is some 8 / sqrt(400,000).
    assert_near(whole / DRAWS, 1.0, 0.06);
    assert_near(drawn / whole_squares, 1.0, 0.08);
}

static void draws_fit_an_image_with_a_sun(void **state)
{
    struct dome dome;

    fill_with_a_sun(&dome);
    // Evenly drawn directions vary by 7; drawn by texels, only as colours differ and as radiance does within a texel.
    assert_draws_fit(&dome, 1.5);
}

static void draws_fit_gradient_and_even_domes(void **state)
{
    struct dome dome = {.along = {1.0, 2.0, 3.0}, .axis = Y};

    // 1e-4: what rounding leaves of a variance of 0.
    assert_draws_fit(&dome, 1e-4);
    dome.kind = SCENE_DOME_GRADIENT;
    for (int c = 0; c < 3; c++)
        dome.against[c] = 8.0 * dome.along[c];
    assert_draws_fit(&dome, 1e-4);
    dome.against[0] = 0.5;
    assert_draws_fit(&dome, 0.5);
}

static void black_domes_are_drawn_evenly(void **state)
{
    struct dome dome = image_dome();
    struct dome_sampler sampler;

    dome_sampler_init(&sampler, &dome);
    assert_near(dome_sampler_density(&sampler, X), 1.0 / (4.0 * M_PI), 1e-15);
    assert_near(vec3_length(dome_sampler_draw(&sampler, (const double[4]){0.3, 0.4, 0.5, 0.6})), 1.0, 1e-14);
    dome_sampler_finish(&sampler);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_dome_is_the_same_everywhere), cmocka_unit_test(gradient_is_linear_in_the_cosine),
        cmocka_unit_test(image_lies_as_the_format_says),    cmocka_unit_test(image_is_bilinear_and_goes_around),
        cmocka_unit_test(first_row_reaches_to_the_pole),    cmocka_unit_test(image_is_turned_about_the_axis),
        cmocka_unit_test(draws_fit_an_image_with_a_sun),    cmocka_unit_test(draws_fit_gradient_and_even_domes),
        cmocka_unit_test(black_domes_are_drawn_evenly),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
