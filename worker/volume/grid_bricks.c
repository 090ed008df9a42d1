// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/grid_bricks.h"

#include "core/base/error.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

bool grid_bricks_init(struct grid_bricks *bricks, const int size[3], struct error *error)
{
    size_t total = 1;

    *bricks = (struct grid_bricks){0};
    for (int i = 0; i < 3; ++i) {
        bricks->size[i] = size[i];
        bricks->count[i] = (size[i] + GRID_BRICK_CELLS - 1) / GRID_BRICK_CELLS;
        total *= (size_t)bricks->count[i];
    }
    bricks->bounds = malloc(total * sizeof *bricks->bounds);
    if (!bricks->bounds) {
        error_set(error, "out of memory: %zu bytes for the bounds of a volume's bricks",
                  total * sizeof *bricks->bounds);
        return false;
    }
    for (size_t i = 0; i < total; ++i)
        bricks->bounds[i] = (struct grid_bound){INFINITY, -INFINITY};
    return true;
}

void grid_bricks_finish(struct grid_bricks *bricks)
{
    free(bricks->bounds);
    *bricks = (struct grid_bricks){0};
}

static void widen(struct grid_bound *bound, float min, float max)
{
    if (min < bound->min) bound->min = min;
    if (max > bound->max) bound->max = max;
}

// Finds the bounds of `count` numbers; each type has its own function, so that it compares in that type.
#define DEFINE_FIND_RANGE(name, type)                                                                                  \
    static struct grid_bound name(const void *row, int count)                                                          \
    {                                                                                                                  \
        const type *values = row;                                                                                      \
        type min = values[0], max = values[0];                                                                         \
                                                                                                                       \
        for (int i = 1; i < count; ++i) {                                                                              \
            min = values[i] < min ? values[i] : min;                                                                   \
            max = values[i] > max ? values[i] : max;                                                                   \
        }                                                                                                              \
        return (struct grid_bound){(float)min, (float)max};                                                            \
    }

DEFINE_FIND_RANGE(find_range_uint8, uint8_t)
DEFINE_FIND_RANGE(find_range_uint16, uint16_t)
DEFINE_FIND_RANGE(find_range_int16, int16_t)
DEFINE_FIND_RANGE(find_range_float32, float)

typedef struct grid_bound find_range(const void *row, int count);

static find_range *find_range_of(enum volume_type type)
{
    switch (type) {
    case VOLUME_UINT8:
        return find_range_uint8;
    case VOLUME_UINT16:
        return find_range_uint16;
    case VOLUME_INT16:
        return find_range_int16;
    case VOLUME_FLOAT32:
        return find_range_float32;
    }
    return NULL;
}

// A voxel on the face between two bricks belongs to both.
static void add_row(struct grid_bricks *bricks, find_range *find, const unsigned char *row, size_t voxel_bytes, int j,
                    int k)
{
    int first_j = j > 0 ? (j - 1) / GRID_BRICK_CELLS : 0, first_k = k > 0 ? (k - 1) / GRID_BRICK_CELLS : 0;

    for (int b = 0; b < bricks->count[0]; ++b) {
        int first = b * GRID_BRICK_CELLS, left = bricks->size[0] - first;
        struct grid_bound range =
            find(row + (size_t)first * voxel_bytes, left > GRID_BRICK_CELLS ? GRID_BRICK_CELLS + 1 : left);

        for (int brick_k = first_k; brick_k <= k / GRID_BRICK_CELLS; ++brick_k)
            for (int brick_j = first_j; brick_j <= j / GRID_BRICK_CELLS; ++brick_j)
                widen(&bricks->bounds[((size_t)brick_k * (size_t)bricks->count[1] + (size_t)brick_j) *
                                          (size_t)bricks->count[0] +
                                      (size_t)b],
                      range.min, range.max);
    }
}

void grid_bricks_add(struct grid_bricks *bricks, enum volume_type type, const void *slices, int first_slice,
                     int slice_count)
{
    size_t voxel_bytes = volume_type_size(type), row_bytes = (size_t)bricks->size[0] * voxel_bytes;
    const unsigned char *row = slices;

    for (int k = first_slice; k < first_slice + slice_count; ++k)
        for (int j = 0; j < bricks->size[1]; ++j, row += row_bytes)
            add_row(bricks, find_range_of(type), row, voxel_bytes, j, k);
}

// Lowers a brick's distance to one more than that of the neighbour (i + di, j + dj, k + dk).
static void relax(const int count[3], unsigned char *distances, const int at[3], const int step[3])
{
    size_t index = 0, neighbour = 0;

    for (int axis = 2; axis >= 0; --axis) {
        int beside = at[axis] + step[axis];

        if (beside < 0 || beside >= count[axis]) return;
        index = index * (size_t)count[axis] + (size_t)at[axis];
        neighbour = neighbour * (size_t)count[axis] + (size_t)beside;
    }
    if (distances[neighbour] + 1 < distances[index]) distances[index] = (unsigned char)(distances[neighbour] + 1);
}

// Relaxes each brick against the 13 neighbours that come before it in `direction`. A sweep in each direction makes the
// chessboard distances exact.
static void sweep(const int count[3], unsigned char *distances, int direction)
{
    size_t total = (size_t)count[0] * (size_t)count[1] * (size_t)count[2];

    for (size_t n = 0; n < total; ++n) {
        size_t index = direction > 0 ? n : total - 1 - n, layer = (size_t)count[0] * (size_t)count[1];
        int at[3] = {(int)(index % (size_t)count[0]), (int)(index % layer / (size_t)count[0]), (int)(index / layer)};

        for (int neighbour = 0; neighbour < 13; ++neighbour) {
            int step[3] = {neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1};

            for (int axis = 0; axis < 3; ++axis)
                step[axis] *= direction;
            relax(count, distances, at, step);
        }
    }
}

void grid_bricks_find_distances(const struct grid_bricks *bricks, double slope, double intercept,
                                grid_bricks_is_empty *is_empty, const void *user, unsigned char *distances)
{
    size_t total = (size_t)bricks->count[0] * (size_t)bricks->count[1] * (size_t)bricks->count[2];

    for (size_t i = 0; i < total; ++i) {
        double a = slope * (double)bricks->bounds[i].min + intercept;
        double b = slope * (double)bricks->bounds[i].max + intercept;

        distances[i] = is_empty(fmin(a, b), fmax(a, b), user) ? GRID_BRICK_FAR : 0;
    }
    sweep(bricks->count, distances, 1);
    sweep(bricks->count, distances, -1);
}
