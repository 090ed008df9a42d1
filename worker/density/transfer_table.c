// SPDX-License-Identifier: Apache-2.0
#include "worker/density/transfer_table.h"

#include "worker/glsl/gauss_legendre.h"

#include <math.h>
#include <string.h>

enum { NODES = 16 };

// Evaluates all four components at a value between the first point's and the last's.
static void evaluate(const struct scene_transfer_point *points, size_t count, double value, double rgba[static 4])
{
    size_t after = 1;
    double share;

    while (after + 1 < count && value > points[after].value)
        after++;
    share = (value - points[after - 1].value) / (points[after].value - points[after - 1].value);
    share = fmin(fmax(share, 0.0), 1.0);
    for (int c = 0; c < 4; c++)
        rgba[c] = points[after - 1].rgba[c] * (1.0 - share) + points[after].rgba[c] * share;
}

// Adds the integral over [low, high], on which all components are linear.
static void add_piece(const struct scene_transfer_point *points, size_t count, double low, double high,
                      double sums[static 4])
{
    double nodes[GAUSS_LEGENDRE_LIMIT], weights[GAUSS_LEGENDRE_LIMIT];

    gauss_legendre(NODES, nodes, weights);
    for (int i = 0; i < NODES; i++) {
        double rgba[4], extinction;

        evaluate(points, count, low + nodes[i] * (high - low), rgba);
        extinction = -log1p(-rgba[3]) * weights[i] * (high - low);
        for (int c = 0; c < 3; c++)
            sums[c] += rgba[c] * extinction;
        sums[3] += extinction;
    }
}

static void add_cell(const struct scene_transfer_point *points, size_t count, double low, double high,
                     double sums[static 4])
{
    for (size_t i = 0; i < count; i++) {
        if (points[i].value <= low || points[i].value >= high) continue;
        add_piece(points, count, low, points[i].value, sums);
        low = points[i].value;
    }
    add_piece(points, count, low, high, sums);
}

// Adds a cell of the common width in which the function is constant.
static void add_end(const struct scene_transfer_point *point, double width, double sums[static 4])
{
    double extinction = -log1p(-point->rgba[3]) * width;

    for (int c = 0; c < 3; c++)
        sums[c] += point->rgba[c] * extinction;
    sums[3] += extinction;
}

void transfer_table_fill(const struct scene_transfer_point *points, size_t count, float table[TRANSFER_TABLE_SIZE][4])
{
    double first = points[0].value, range = points[count - 1].value - first, width = range / TRANSFER_TABLE_CELLS;
    double sums[4] = {0.0};

    memset(table[0], 0, sizeof table[0]);
    for (int i = 1; i < TRANSFER_TABLE_SIZE; i++) {
        if (i == 1)
            add_end(&points[0], width, sums);
        else if (i == TRANSFER_TABLE_SIZE - 1)
            add_end(&points[count - 1], width, sums);
        else
            add_cell(points, count, first + range * (i - 2) / TRANSFER_TABLE_CELLS,
                     first + range * (i - 1) / TRANSFER_TABLE_CELLS, sums);
        for (int c = 0; c < 4; c++)
            table[i][c] = (float)(sums[c] / width);
    }
}
