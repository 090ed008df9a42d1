// SPDX-License-Identifier: Apache-2.0
#include "reference/glow_blackbody.h"

#include "reference/blackbody.h"

#include <math.h>
#include <stddef.h>

// Below it there is no light, as in blackbody_rgb.
static const double COLDEST = 400.0;

// Chebyshev's nodes in [-1, 1].
static double node(int i)
{
    return cos(M_PI * (i + 0.5) / GLOW_BLACKBODY_NODES);
}

static double hottest_of(const struct glow_blackbody *field)
{
    const struct grid *grid = &field->grid;
    size_t count = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    double hottest = 0.0;

    for (size_t i = 0; i < count; i++)
        hottest = fmax(hottest, field->kelvin * grid->values[i]);
    return hottest;
}

void glow_blackbody_init(struct glow_blackbody *field, const struct glow_blackbody_params *params)
{
    *field = (struct glow_blackbody){.kelvin = params->kelvin, .intensity = params->intensity};
    grid_init(&field->grid, &params->grid);
    field->coldness_high = 1.0 / COLDEST;
    // Twice, so that a grid of one temperature has a range.
    field->coldness_low = 1.0 / fmax(2.0 * COLDEST, hottest_of(field));
    for (int i = 0; i < GLOW_BLACKBODY_NODES; i++) {
        double middle = 0.5 * (field->coldness_low + field->coldness_high);
        double xyz[3];

        blackbody_xyz(1.0 / (middle + 0.5 * (field->coldness_high - field->coldness_low) * node(i)), xyz);
        for (int c = 0; c < 3; c++)
            field->log_xyz[i][c] = log(xyz[c]);
    }
}

// Barycentric interpolation. Berrut and Trefethen, SIAM Review 46, 2004.
static void interpolate(const struct glow_blackbody *field, double kelvin, double xyz[static 3])
{
    double middle = 0.5 * (field->coldness_low + field->coldness_high);
    double x = (1.0 / kelvin - middle) / (0.5 * (field->coldness_high - field->coldness_low));
    double weights = 0.0, sum[3] = {0.0, 0.0, 0.0};

    for (int i = 0; i < GLOW_BLACKBODY_NODES; i++) {
        double weight = (i % 2 ? -1.0 : 1.0) * sin(M_PI * (i + 0.5) / GLOW_BLACKBODY_NODES);
        // Beside a node by a rounding the value is the node's, as it should be.
        double away = x != node(i) ? x - node(i) : 1e-300;

        weights += weight / away;
        for (int c = 0; c < 3; c++)
            sum[c] += weight / away * field->log_xyz[i][c];
    }
    for (int c = 0; c < 3; c++)
        xyz[c] = exp(sum[c] / weights);
}

static void glow_at(const void *field, struct vec3 position, double source[static 3])
{
    const struct glow_blackbody *blackbody = field;
    double kelvin, xyz[3];

    source[0] = source[1] = source[2] = 0.0;
    if (!grid_contains(&blackbody->grid, position)) return;
    kelvin = blackbody->kelvin * grid_value(&blackbody->grid, position);
    if (!(kelvin > COLDEST)) return;
    interpolate(blackbody, kelvin, xyz);
    blackbody_xyz_to_rgb(xyz, source);
    for (int c = 0; c < 3; c++)
        source[c] *= blackbody->intensity;
}

static void split(const void *field, const struct ray *ray, struct span_list *spans)
{
    const struct glow_blackbody *blackbody = field;
    struct span_list cells = {0};
    struct grid_stretch stretch;
    struct grid_walk walk;

    grid_walk_init(&walk, &blackbody->grid, ray, -INFINITY, INFINITY);
    while (grid_walk_next(&walk, &stretch))
        span_list_append(&cells, stretch.begin, stretch.end, NULL);
    span_list_split_at_ends(spans, &cells);
    span_list_finish(&cells);
}

struct medium_glow glow_blackbody(const struct glow_blackbody *field)
{
    return (struct medium_glow){.field = field, .at = glow_at, .split = split};
}
