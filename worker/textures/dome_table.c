// SPDX-License-Identifier: Apache-2.0
#include "worker/textures/dome_table.h"

#include "core/base/alloc.h"

#include <math.h>
#include <stdlib.h>

void dome_table_size(int width_px, int height_px, int *table_width_px, int *table_height_px)
{
    *table_width_px = width_px > height_px ? width_px : height_px;
    *table_height_px = height_px + 1;
}

// Of a row of the table, for `count` weights whose sum is `sum`. A texel that has less than its even share of the
// weights lends the rest of its place to one that has more.
struct alias_row {
    const double *weights;
    size_t count;
    double sum;
    float *rgba; // of the table
};

static void fill_aliases(const struct alias_row *row, double *left, size_t *stack)
{
    size_t poor = 0, rich = row->count; // counts: the poor are stacked from below, the rich from above

    for (size_t i = 0; i < row->count; ++i) {
        left[i] = row->sum > 0.0 ? row->weights[i] / row->sum * (double)row->count : 1.0;
        row->rgba[4 * i] = 1.0F;
        row->rgba[4 * i + 1] = (float)i;
        stack[left[i] < 1.0 ? poor++ : --rich] = i;
    }
    while (poor > 0 && rich < row->count) {
        size_t lender = stack[--poor], taker = stack[rich];

        row->rgba[4 * lender] = (float)left[lender];
        row->rgba[4 * lender + 1] = (float)taker;
        left[taker] -= 1.0 - left[lender];
        if (left[taker] >= 1.0) continue;
        ++rich;
        stack[poor++] = taker;
    }
}

static double color_mean(const struct image *image, size_t column, size_t row)
{
    const float *rgba = &image->rgba[4 * (row * (size_t)image->width_px + column)];

    return ((double)rgba[0] + (double)rgba[1] + (double)rgba[2]) / 3.0;
}

// The mean over a texel of what is bilinear between the middles of texels: an eighth is a neighbour's on each side.
static double texel_mean(const struct image *image, size_t column, size_t row)
{
    size_t width = (size_t)image->width_px, height = (size_t)image->height_px;
    size_t columns[] = {(column + width - 1) % width, column, (column + 1) % width};
    size_t rows[] = {row > 0 ? row - 1 : 0, row, row + 1 < height ? row + 1 : row};
    double mean = 0.0;

    for (size_t j = 0; j < 3; ++j)
        for (size_t i = 0; i < 3; ++i)
            mean += (j == 1 ? 0.75 : 0.125) * (i == 1 ? 0.75 : 0.125) * color_mean(image, columns[i], rows[j]);
    return mean;
}

static double texel_angle(const struct image *image, size_t row)
{
    double top = M_PI * (0.5 - (double)row / image->height_px);
    double bottom = M_PI * (0.5 - ((double)row + 1.0) / image->height_px);

    return 2.0 * M_PI / image->width_px * (sin(top) - sin(bottom));
}

static void fill(struct image *table, const struct image *image)
{
    size_t width = (size_t)image->width_px, height = (size_t)image->height_px, side = (size_t)table->width_px;
    double *weights = xcalloc(2 * side + height, sizeof *weights), *left = weights + side, *rows = left + side;
    size_t *stack = xcalloc(side, sizeof *stack);
    double total = 0.0;

    for (size_t row = 0; row < height; ++row) {
        for (size_t column = 0; column < width; ++column) {
            weights[column] = texel_mean(image, column, row) * texel_angle(image, row);
            rows[row] += weights[column];
            table->rgba[4 * (row * side + column) + 2] = (float)(weights[column] / texel_angle(image, row));
        }
        fill_aliases(&(struct alias_row){weights, width, rows[row], &table->rgba[4 * row * side]}, left, stack);
        total += rows[row];
    }
    for (size_t row = 0; row < height && total == 0.0; ++row)
        rows[row] = texel_angle(image, row);
    fill_aliases(&(struct alias_row){rows, height, total > 0.0 ? total : 4.0 * M_PI / (double)width,
                                     &table->rgba[4 * height * side]},
                 left, stack);
    for (size_t i = 0; i < height * side; ++i)
        table->rgba[4 * i + 2] = total > 0.0 ? (float)((double)table->rgba[4 * i + 2] / total) : (float)(0.25 / M_PI);
    free(stack);
    free(weights);
}

bool dome_table_init(struct image *table, const struct image *image, struct error *error)
{
    int width, height;

    dome_table_size(image->width_px, image->height_px, &width, &height);
    if (!image_init(table, width, height, false, false, error)) return false;
    for (size_t i = 0; i < 4 * (size_t)width * (size_t)height; ++i)
        table->rgba[i] = 0.0F;
    fill(table, image);
    return true;
}
