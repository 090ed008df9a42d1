// SPDX-License-Identifier: Apache-2.0
#include "reference/grid.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>

static double product(const double *row, struct vec3 v)
{
    return row[0] * v.x + row[1] * v.y + row[2] * v.z;
}

static void invert(const double m[static 12], double inverse[static 12])
{
    struct vec3 a = {m[0], m[4], m[8]}, b = {m[1], m[5], m[9]}, c = {m[2], m[6], m[10]};
    struct vec3 shift = {m[3], m[7], m[11]};
    double volume = vec3_dot(a, vec3_cross(b, c));
    struct vec3 rows[3] = {vec3_cross(b, c), vec3_cross(c, a), vec3_cross(a, b)};

    for (int i = 0; i < 3; i++) {
        struct vec3 row = vec3_scale(rows[i], 1.0 / volume);

        inverse[4 * i] = row.x;
        inverse[4 * i + 1] = row.y;
        inverse[4 * i + 2] = row.z;
        inverse[4 * i + 3] = -vec3_dot(row, shift);
    }
}

void grid_init(struct grid *grid, const struct grid_params *params)
{
    *grid = (struct grid){.values = params->values,
                          .size = {params->size[0], params->size[1], params->size[2]},
                          .is_nearest = params->is_nearest,
                          .margin = params->is_padded ? 0.0 : 0.5};
    invert(params->index_to_world, grid->world_to_index);
}

static void find_index(const struct grid *grid, struct vec3 position, double index[static 3])
{
    for (int a = 0; a < 3; a++)
        index[a] = product(&grid->world_to_index[4 * a], position) + grid->world_to_index[4 * a + 3];
}

static bool is_within(const struct grid *grid, const double index[static 3])
{
    for (int a = 0; a < 3; a++)
        if (index[a] < -grid->margin || index[a] > grid->size[a] - 1 + grid->margin) return false;
    return true;
}

bool grid_contains(const struct grid *grid, struct vec3 position)
{
    double index[3];

    find_index(grid, position, index);
    return is_within(grid, index);
}

static int clamp(double index, int size)
{
    return index < 0.0 ? 0 : index > size - 1 ? size - 1 : (int)index;
}

// The voxel of an integer index, or the outermost voxel in its direction.
static double voxel(const struct grid *grid, const double index[static 3])
{
    size_t i = (size_t)clamp(index[0], grid->size[0]), j = (size_t)clamp(index[1], grid->size[1]);
    size_t k = (size_t)clamp(index[2], grid->size[2]);

    return grid->values[i + (size_t)grid->size[0] * (j + (size_t)grid->size[1] * k)];
}

// The lowest corner of the cell around an index.
static void find_cell(const struct grid *grid, const double index[static 3], double cell[static 3])
{
    for (int a = 0; a < 3; a++)
        cell[a] = grid->is_nearest ? floor(index[a] + 0.5) : floor(index[a]);
}

// Corner n lies towards x, y and z by its bits 0, 1 and 2.
static void find_corners(const struct grid *grid, const double cell[static 3], double corners[static 8])
{
    for (int n = 0; n < 8; n++) {
        double corner[3];

        for (int a = 0; a < 3; a++)
            corner[a] = cell[a] + (grid->is_nearest ? 0 : n >> a & 1);
        corners[n] = voxel(grid, corner);
    }
}

// The corners of a cell whose voxels all lie within the grid; false: some do not.
static bool find_inner_corners(const struct grid *grid, const double cell[static 3], double corners[static 8])
{
    size_t row = (size_t)grid->size[0], slice = row * (size_t)grid->size[1];
    const float *voxels;

    if (grid->is_nearest) return false;
    for (int a = 0; a < 3; a++)
        if (!(cell[a] >= 0.0 && cell[a] <= grid->size[a] - 2)) return false;
    voxels = grid->values + (size_t)cell[0] + row * (size_t)cell[1] + slice * (size_t)cell[2];
    for (size_t n = 0; n < 8; n++)
        corners[n] = voxels[(n & 1) + row * (n >> 1 & 1) + slice * (n >> 2)];
    return true;
}

static double value_at(const struct grid *grid, const double index[static 3])
{
    double cell[3], corners[8];
    int count = 8;

    find_cell(grid, index, cell);
    if (!find_inner_corners(grid, cell, corners)) find_corners(grid, cell, corners);
    for (int a = 0; a < 3; a++) {
        double share = index[a] - cell[a];

        count /= 2;
        for (int n = 0; n < count; n++)
            corners[n] = corners[2 * n] + (corners[2 * n + 1] - corners[2 * n]) * share;
    }
    return corners[0];
}

double grid_value(const struct grid *grid, struct vec3 position)
{
    double index[3];

    find_index(grid, position, index);
    return value_at(grid, index);
}

bool grid_find(const struct grid *grid, struct vec3 position, double *value)
{
    double index[3];

    find_index(grid, position, index);
    if (!is_within(grid, index)) return false;
    *value = value_at(grid, index);
    return true;
}

// The range of an axis' voxels on which values between two indices depend; false: it lies outside of the box.
static bool find_voxels(const struct grid *grid, int axis, double low, double high, int *first, int *last)
{
    int size = grid->size[axis];

    if (high < -grid->margin || low > size - 1 + grid->margin) return false;
    *first = clamp(grid->is_nearest ? floor(low + 0.5) : floor(low), size);
    *last = clamp(grid->is_nearest ? floor(high + 0.5) : floor(high) + 1.0, size);
    return true;
}

bool grid_range(const struct grid *grid, const struct box *box, double *low, double *high)
{
    // Rounding may move an index to the next voxel.
    const double sliver = 1e-9;
    double center[3];
    int first[3], last[3];

    find_index(grid, box->center, center);
    for (int a = 0; a < 3; a++) {
        const double *row = &grid->world_to_index[4 * a];
        double half = fabs(row[0]) * box->half.x + fabs(row[1]) * box->half.y + fabs(row[2]) * box->half.z;

        half += sliver * (1.0 + fabs(center[a]));
        if (isnan(half) || isinf(half)) half = INFINITY;
        if (!find_voxels(grid, a, center[a] - half, center[a] + half, &first[a], &last[a])) return false;
    }
    *low = INFINITY;
    *high = -INFINITY;
    for (int k = first[2]; k <= last[2]; k++)
        for (int j = first[1]; j <= last[1]; j++) {
            const float *row = &grid->values[(size_t)grid->size[0] * ((size_t)j + (size_t)grid->size[1] * (size_t)k)];

            for (int i = first[0]; i <= last[0]; i++) {
                *low = fmin(*low, row[i]);
                *high = fmax(*high, row[i]);
            }
        }
    return true;
}

void grid_extent(const struct grid *grid, struct box *box)
{
    double to_world[12], center[3], half[3] = {0.0, 0.0, 0.0};

    invert(grid->world_to_index, to_world);
    for (int a = 0; a < 3; a++) {
        const double *row = &to_world[4 * a];

        center[a] = row[3];
        for (int b = 0; b < 3; b++) {
            center[a] += row[b] * 0.5 * (grid->size[b] - 1);
            half[a] += fabs(row[b]) * (0.5 * (grid->size[b] - 1) + grid->margin);
        }
    }
    *box = (struct box){vec3_from(center), vec3_from(half)};
}

void grid_walk_init(struct grid_walk *walk, const struct grid *grid, const struct ray *ray, double near, double far)
{
    *walk = (struct grid_walk){.grid = grid};
    find_index(grid, ray->origin, walk->origin);
    for (int a = 0; a < 3; a++) {
        double low = -grid->margin - walk->origin[a], high = grid->size[a] - 1 + grid->margin - walk->origin[a];
        double slope = product(&grid->world_to_index[4 * a], ray->direction);

        walk->direction[a] = slope;
        if (slope == 0.0) {
            if (low > 0.0 || high < 0.0) far = near;
            continue;
        }
        near = fmax(near, fmin(low / slope, high / slope));
        far = fmin(far, fmax(low / slope, high / slope));
    }
    walk->at = near;
    walk->far = far;
}

// The distance at which the ray next passes a plane between cells.
static double next_plane(const struct grid_walk *walk, int axis)
{
    double origin = walk->origin[axis], slope = walk->direction[axis];
    double shift = walk->grid->is_nearest ? 0.5 : 0.0;
    double here = origin + slope * walk->at - shift, plane, at;

    if (slope == 0.0) return INFINITY;
    plane = slope > 0.0 ? floor(here) + 1.0 : ceil(here) - 1.0;
    at = (plane + shift - origin) / slope;
    // Rounding may give the plane just passed.
    return at > walk->at ? at : (plane + copysign(1.0, slope) + shift - origin) / slope;
}

// value = a + (b - a) (share + slope s), for cubics a and b of degree `degree`.
static void interpolate(const double a[static 4], const double b[static 4], int degree, double share, double slope,
                        double value[static 4])
{
    double sum[4] = {0.0, 0.0, 0.0, 0.0};

    assert(degree < 3);
    for (int n = 0; n <= degree; n++) {
        sum[n] += a[n] + (b[n] - a[n]) * share;
        sum[n + 1] += (b[n] - a[n]) * slope;
    }
    for (int n = 0; n < 4; n++)
        value[n] = sum[n];
}

static void fit(const struct grid_walk *walk, struct grid_stretch *stretch)
{
    double middle[3], cell[3], corners[8], cubics[8][4] = {{0.0}};
    int count = 8;

    for (int a = 0; a < 3; a++)
        middle[a] = walk->origin[a] + walk->direction[a] * 0.5 * (stretch->begin + stretch->end);
    find_cell(walk->grid, middle, cell);
    find_corners(walk->grid, cell, corners);
    stretch->low = stretch->high = corners[0];
    for (int n = 0; n < 8; n++) {
        stretch->low = fmin(stretch->low, corners[n]);
        stretch->high = fmax(stretch->high, corners[n]);
        cubics[n][0] = corners[n];
    }
    for (int a = 0; a < 3; a++) {
        double share = walk->origin[a] + walk->direction[a] * stretch->begin - cell[a];
        double slope = walk->direction[a] * (stretch->end - stretch->begin);

        count /= 2;
        for (int n = 0; n < count; n++)
            interpolate(cubics[2 * n], cubics[2 * n + 1], a, share, slope, cubics[n]);
    }
    for (int n = 0; n < 4; n++)
        stretch->cubic[n] = cubics[0][n];
}

bool grid_walk_next(struct grid_walk *walk, struct grid_stretch *stretch)
{
    if (!(walk->at < walk->far)) return false;
    stretch->begin = walk->at;
    stretch->end = walk->far;
    for (int a = 0; a < 3; a++)
        stretch->end = fmin(stretch->end, next_plane(walk, a));
    fit(walk, stretch);
    walk->at = stretch->end;
    return true;
}
