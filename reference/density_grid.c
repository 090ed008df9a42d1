// SPDX-License-Identifier: Apache-2.0
#include "reference/density_grid.h"

#include "reference/cubic.h"

#include <math.h>

static double at(const void *field, struct vec3 position)
{
    const struct density_grid *density = field;
    double value;

    if (!grid_find(&density->grid, position, &value)) return 0.0;
    if (density->has_transfer) return transfer_function_extinction(&density->transfer, value);
    return density->scale * fmax(value, 0.0);
}

static bool is_clear(const struct density_grid *density, const struct grid_stretch *stretch)
{
    if (density->has_transfer) return transfer_function_is_clear(&density->transfer, stretch->low, stretch->high);
    return !(density->scale * stretch->high > 0.0);
}

static void split_at_level(struct span_list *spans, const struct grid_stretch *stretch, double level)
{
    double crossings[3];
    int count;

    if (!(stretch->low < level && level < stretch->high)) return;
    count = cubic_find_crossings(stretch->cubic, level, crossings);
    for (int i = 0; i < count; i++)
        span_list_split(spans, stretch->begin + crossings[i] * (stretch->end - stretch->begin));
}

static void find_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    const struct density_grid *density = field;
    struct grid_stretch stretch;
    struct grid_walk walk;

    grid_walk_init(&walk, &density->grid, ray, near, far);
    while (grid_walk_next(&walk, &stretch)) {
        if (is_clear(density, &stretch)) continue;
        span_list_append(spans, stretch.begin, stretch.end, NULL);
        if (!density->has_transfer) {
            split_at_level(spans, &stretch, 0.0);
            continue;
        }
        for (size_t i = 0; i < density->transfer.count; i++)
            split_at_level(spans, &stretch, density->transfer.points[i].value);
    }
}

// The integral over [0, 1] of the cubic where it is positive.
static double positive_integral(const struct grid_stretch *stretch)
{
    double crossings[3], sum = 0.0, begin = 0.0;
    int count = cubic_find_crossings(stretch->cubic, 0.0, crossings);

    for (int i = 0; i <= count; i++) {
        double end = i < count ? crossings[i] : 1.0;

        if (cubic_at(stretch->cubic, 0.5 * (begin + end)) > 0.0) sum += cubic_integral(stretch->cubic, begin, end);
        begin = end;
    }
    return sum;
}

static double find_column(const void *field, const struct ray *ray, double near, double far)
{
    const struct density_grid *density = field;
    struct grid_stretch stretch;
    struct grid_walk walk;
    double column = 0.0;

    grid_walk_init(&walk, &density->grid, ray, near, far);
    while (grid_walk_next(&walk, &stretch)) {
        double length = stretch.end - stretch.begin;

        if (stretch.high <= 0.0) continue;
        column += length * (stretch.low >= 0.0 ? cubic_integral(stretch.cubic, 0.0, 1.0) : positive_integral(&stretch));
    }
    return density->scale * column;
}

static double find_most(const void *field, const struct box *box)
{
    const struct density_grid *density = field;
    double low, high;

    if (!grid_range(&density->grid, box, &low, &high)) return 0.0;
    if (density->has_transfer) return transfer_function_most(&density->transfer, low, high);
    return density->scale * fmax(high, 0.0);
}

static bool find_extent(const void *field, struct box *box)
{
    const struct density_grid *density = field;

    grid_extent(&density->grid, box);
    return true;
}

struct density density_grid(const struct density_grid *field)
{
    return (struct density){.field = field,
                            .at = at,
                            .spans = find_spans,
                            .column = field->has_transfer ? NULL : find_column,
                            .most = find_most,
                            .extent = find_extent};
}

static void glow_at(const void *field, struct vec3 position, double source[static 3])
{
    const struct density_grid *density = field;

    transfer_function_color(&density->transfer, grid_value(&density->grid, position), source);
}

struct medium_glow density_grid_glow(const struct density_grid *field)
{
    return (struct medium_glow){.field = field, .at = glow_at};
}
