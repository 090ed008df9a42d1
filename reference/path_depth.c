// SPDX-License-Identifier: Apache-2.0
#include "reference/path_depth.h"

#include "core/base/alloc.h"

#include <math.h>
#include <stdlib.h>

enum { CELLS = 16, ALL_CELLS = CELLS * CELLS * CELLS };

static const double STEPS = 2.0; // a cell

static bool varies(const struct medium *medium)
{
    return !(medium->density.column && medium->density.reach) && medium->density.extent && medium->region == 0;
}

// False: no density varies.
static bool find_box(const struct still *still, struct vec3 *low, struct vec3 *high)
{
    *low = (struct vec3){INFINITY, INFINITY, INFINITY};
    *high = vec3_scale(*low, -1.0);
    for (size_t i = 0; i < still->medium_count; i++) {
        const struct density *density = &still->media[i].density;
        struct box box;

        if (!varies(&still->media[i]) || !density->extent(density->field, &box)) continue;
        *low = (struct vec3){fmin(low->x, box.center.x - box.half.x), fmin(low->y, box.center.y - box.half.y),
                             fmin(low->z, box.center.z - box.half.z)};
        *high = (struct vec3){fmax(high->x, box.center.x + box.half.x), fmax(high->y, box.center.y + box.half.y),
                              fmax(high->z, box.center.z + box.half.z)};
    }
    return low->x < high->x && low->y < high->y && low->z < high->z;
}

// The index of the cell; negative: outside.
static int find_cell(const struct path_depth *depth, struct vec3 position)
{
    double x = (position.x - depth->low.x) / depth->side[0], y = (position.y - depth->low.y) / depth->side[1];
    double z = (position.z - depth->low.z) / depth->side[2];

    if (!(x >= 0.0 && y >= 0.0 && z >= 0.0 && x < CELLS && y < CELLS && z < CELLS)) return -1;
    return (int)x + CELLS * ((int)y + CELLS * (int)z);
}

static struct vec3 middle_of(const struct path_depth *depth, int cell)
{
    int y = cell / CELLS, z = y / CELLS;
    struct vec3 offset = {(cell % CELLS + 0.5) * depth->side[0], (y % CELLS + 0.5) * depth->side[1],
                          (z + 0.5) * depth->side[2]};

    return vec3_add(depth->low, offset);
}

static double extinction_at(const struct still *still, struct vec3 position)
{
    double sum = 0.0;

    for (size_t i = 0; i < still->medium_count; i++) {
        const struct medium *medium = &still->media[i];
        double most = 0.0;

        for (int c = 0; c < 3; c++)
            most = fmax(most, medium->sigma_s[c] + medium->sigma_a[c]);
        if (varies(medium)) sum += most * medium->density.at(medium->density.field, position);
    }
    return sum;
}

static struct light_arrival arrive(const struct still *still, size_t lamp, struct vec3 position)
{
    struct light_arrival arrival;
    struct vec3 away;

    if (lamp < still->light_count) return light_arrive(&still->lights[lamp], position);
    away = vec3_subtract(position, still->spheres[lamp - still->light_count].center);
    arrival = (struct light_arrival){.distance = vec3_length(away)};
    if (arrival.distance > 0.0) arrival.travel = vec3_scale(away, 1.0 / arrival.distance);
    return arrival;
}

static double march(const struct path_depth *depth, const double *extinctions, struct vec3 position,
                    const struct light_arrival *arrival)
{
    double step = fmin(fmin(depth->side[0], depth->side[1]), depth->side[2]) / STEPS, sum = 0.0;
    int cell;

    for (int i = 0; (i + 0.5) * step < arrival->distance; i++) {
        cell = find_cell(depth, vec3_subtract(position, vec3_scale(arrival->travel, (i + 0.5) * step)));
        if (cell < 0) break;
        sum += extinctions[cell] * step;
    }
    return sum;
}

void path_depth_init(struct path_depth *depth, const struct still *still)
{
    size_t lamps = still->light_count + still->sphere_count;
    struct vec3 high;
    double *extinctions;

    *depth = (struct path_depth){0};
    if (lamps == 0 || !find_box(still, &depth->low, &high)) return;
    high = vec3_scale(vec3_subtract(high, depth->low), 1.0 / CELLS);
    depth->side[0] = high.x;
    depth->side[1] = high.y;
    depth->side[2] = high.z;
    extinctions = xcalloc(ALL_CELLS, sizeof *extinctions);
    depth->depths = xcalloc(lamps * ALL_CELLS, sizeof *depth->depths);
    for (int i = 0; i < ALL_CELLS; i++)
        extinctions[i] = extinction_at(still, middle_of(depth, i));
    for (size_t k = 0; k < lamps; k++)
        for (int i = 0; i < ALL_CELLS; i++) {
            struct vec3 middle = middle_of(depth, i);
            struct light_arrival arrival = arrive(still, k, middle);

            depth->depths[k * ALL_CELLS + (size_t)i] = (float)march(depth, extinctions, middle, &arrival);
        }
    free(extinctions);
}

void path_depth_finish(struct path_depth *depth)
{
    free(depth->depths);
    *depth = (struct path_depth){0};
}

double path_depth_at(const struct path_depth *depth, size_t lamp, struct vec3 position)
{
    int cell = depth->depths ? find_cell(depth, position) : -1;

    return cell < 0 ? 0.0 : depth->depths[lamp * ALL_CELLS + (size_t)cell];
}
