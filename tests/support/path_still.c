// SPDX-License-Identifier: Apache-2.0
#include "tests/support/path_still.h"

#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 10 };

static struct medium *add(struct still *still, double sigma_s, double sigma_a)
{
    struct medium *medium = &still->media[still->medium_count++];

    *medium = (struct medium){0};
    for (int c = 0; c < 3; c++) {
        medium->sigma_s[c] = sigma_s;
        medium->sigma_a[c] = sigma_a;
    }
    return medium;
}

static size_t slot_of(const struct still *still, const struct medium *medium)
{
    return (size_t)(medium - still->media);
}

static void bound(struct still *still, struct medium *medium, const struct bounds *bounds)
{
    struct density_bounded *bounded = &still->bounded[slot_of(still, medium)];

    *bounded = (struct density_bounded){medium->density, *bounds};
    medium->density = density_bounded(bounded);
}

static struct medium *add_even(struct still *still, double sigma_s, double sigma_a, const struct bounds *bounds)
{
    struct medium *medium = add(still, sigma_s, sigma_a);
    struct density_homogeneous *field = &still->fields[slot_of(still, medium)].homogeneous;

    field->scale = 1.0;
    medium->density = density_homogeneous(field);
    bound(still, medium, bounds);
    return medium;
}

struct medium *path_still_add_ball(struct still *still, struct vec3 center, double radius, double sigma_s,
                                   double sigma_a)
{
    return add_even(still, sigma_s, sigma_a,
                    &(struct bounds){.kind = SCENE_BOUNDS_SPHERE, .center = center, .radius = radius});
}

struct medium *path_still_add_box(struct still *still, struct vec3 half, double sigma_s, double sigma_a)
{
    return add_even(still, sigma_s, sigma_a, &(struct bounds){.kind = SCENE_BOUNDS_BOX, .half = half});
}

struct medium *path_still_add_slab(struct still *still, double thickness, double sigma_s, double sigma_a)
{
    return add_even(
        still, sigma_s, sigma_a,
        &(struct bounds){.kind = SCENE_BOUNDS_SLAB, .normal = {0.0, 0.0, 1.0}, .half_thickness = 0.5 * thickness});
}

struct medium *path_still_add_fold(struct still *still, double sigma_s, double sigma_a)
{
    struct medium *medium = add(still, sigma_s, sigma_a);
    struct density_fold_fractal *field = &still->fields[slot_of(still, medium)].fold_fractal;

    density_fold_fractal_init(field, &(struct density_fold_fractal_params){.iterations = 6,
                                                                           .offset = 0.3,
                                                                           .radius = 0.5,
                                                                           .exponent = 0.7,
                                                                           .scale = 3.0,
                                                                           .rotate_x_rad = 0.4,
                                                                           .rotate_y_rad = -0.2});
    medium->density = still_fractal_density(field);
    return medium;
}

struct medium *path_still_add_noise(struct still *still, enum scene_noise_mode mode, double sigma_s, double sigma_a)
{
    struct medium *medium = add(still, sigma_s, sigma_a);
    struct density_noise *field = &still->fields[slot_of(still, medium)].noise;

    density_noise_init(field, &(struct density_noise_params){.octaves = 4,
                                                             .mode = mode,
                                                             .frequency = 2.0,
                                                             .lacunarity = 2.1,
                                                             .hurst = 0.8,
                                                             .bias = 0.2,
                                                             .offset = {0.3, 7.1, -3.7},
                                                             .axis = {1.0, 2.0, 0.5},
                                                             .angle_deg = 33.0,
                                                             .scale = 2.0});
    medium->density = density_noise_field(field);
    bound(still, medium, &(struct bounds){.kind = SCENE_BOUNDS_SPHERE, .radius = 1.0, .falloff = 0.4});
    return medium;
}

struct medium *path_still_add_grid(struct still *still, double sigma_s, double sigma_a)
{
    static const double PLACEMENT[12] = {0.2, 0.03, 0.0, 0.0, -0.02, 0.17, 0.04, 0.0, 0.01, -0.04, 0.19, 0.0};
    static float values[SIDE * SIDE * SIDE];
    struct grid_params params = {.values = values, .size = {SIDE, SIDE, SIDE}};
    struct medium *medium = add(still, sigma_s, sigma_a);
    struct density_grid *field = &still->fields[slot_of(still, medium)].grid;
    struct random random = {5};

    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        values[i] = (float)random_between(&random, -1.0, 2.0);
    memcpy(params.index_to_world, PLACEMENT, sizeof PLACEMENT);
    for (int a = 0; a < 3; a++) {
        double *row = &params.index_to_world[4 * a];

        row[3] = -0.5 * (SIDE - 1) * (row[0] + row[1] + row[2]);
    }
    *field = (struct density_grid){.scale = 1.5};
    grid_init(&field->grid, &params);
    medium->density = density_grid(field);
    return medium;
}

void path_still_set_g(struct medium *medium, double g)
{
    medium->lobe_count = 1;
    medium->lobes[0] = (struct medium_lobe){.kind = SCENE_LOBE_HENYEY_GREENSTEIN, .g = g, .weight = 1.0};
}

static void add_light(struct still *still, const struct light *light, double intensity)
{
    struct light *added = &still->lights[still->light_count++];

    *added = *light;
    for (int c = 0; c < 3; c++)
        added->intensity[c] = intensity;
}

void path_still_add_point(struct still *still, struct vec3 position, double intensity)
{
    add_light(still, &(struct light){.kind = SCENE_LIGHT_POINT, .position = position}, intensity);
}

void path_still_add_sun(struct still *still, struct vec3 direction, double irradiance)
{
    add_light(still, &(struct light){.kind = SCENE_LIGHT_SUN, .direction = vec3_normalize(direction)}, irradiance);
}

void path_still_set_dome(struct still *still, double radiance)
{
    still->has_dome = true;
    still->dome = (struct dome){.kind = SCENE_DOME_RADIANCE, .along = {radiance, radiance, radiance}};
}

void path_still_check(double mean, double error, double truth, double error_most, double rounding, const char *file,
                      int line)
{
    double off = fabs(mean - truth);

    if (off <= 5.0 * error + rounding && error <= error_most * fabs(truth)) return;
    print_error("%.8g +- %.2g is not %.8g: off by %.2g, %.1f standard errors; error %.2g of it\n", mean, error, truth,
                off, error > 0.0 ? off / error : 0.0, error / fabs(truth));
    _fail(file, line);
}
