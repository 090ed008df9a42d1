// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/view_shrink.h"

#include "core/base/error.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

// Which cells of the result a line or column of the part lies in, and how much of it in the first.
struct cover {
    int first, last; // they differ by at most 1, for nothing is enlarged
    float first_share;
};

static struct cover find_cover(int at, int count, int cell_count)
{
    double start = (double)at * cell_count / count, stop = (double)(at + 1) * cell_count / count;
    struct cover cover = {.first = (int)start, .first_share = 1.0f};

    if (cover.first >= cell_count) cover.first = cell_count - 1;
    cover.last = cover.first;
    if (stop > cover.first + 1.0 && cover.first + 1 < cell_count) {
        cover.last = cover.first + 1;
        cover.first_share = (float)((cover.first + 1.0 - start) / (stop - start));
    }
    return cover;
}

static int scale_side(int side_px, int longest_px, int size_px)
{
    int scaled;

    if (longest_px <= size_px) return side_px;
    scaled = (int)lround((double)side_px * size_px / longest_px);
    return scaled > 0 ? scaled : 1;
}

bool view_shrink_init(struct view_shrink *shrink, const struct view_part *part, int size_px, enum view_shrink_kind kind,
                      struct error *error)
{
    int longest = part->width_px > part->height_px ? part->width_px : part->height_px;

    *shrink = (struct view_shrink){.part = *part,
                                   .kind = kind,
                                   .width_px = scale_side(part->width_px, longest, size_px),
                                   .height_px = scale_side(part->height_px, longest, size_px),
                                   .planes = kind == VIEW_SHRINK_ONE     ? 1
                                             : kind == VIEW_SHRINK_DEPTH ? 2
                                                                         : 3};
    shrink->sums = calloc((size_t)shrink->width_px * (size_t)shrink->height_px * shrink->planes, sizeof *shrink->sums);
    if (shrink->sums) return true;
    error_set(error, "no memory for %d x %d pixels", shrink->width_px, shrink->height_px);
    return false;
}

void view_shrink_finish(struct view_shrink *shrink)
{
    free(shrink->sums);
    *shrink = (struct view_shrink){0};
}

static void add_value(const struct view_shrink *shrink, float *sums, float value, float share)
{
    if (!isfinite(value)) return;
    if (shrink->kind != VIEW_SHRINK_DEPTH) {
        sums[0] += value * share;
    } else if (value > 0) {
        sums[0] += value * share;
        sums[1] += share;
    }
}

static void add_row(struct view_shrink *shrink, int to_row, const float *values, size_t width, float row_share)
{
    size_t channels = shrink->kind == VIEW_SHRINK_THREE ? 3 : 1;

    for (int x = 0; x < shrink->part.width_px; x++) {
        struct cover cover = find_cover(x, shrink->part.width_px, shrink->width_px);
        float *first =
            shrink->sums + ((size_t)to_row * (size_t)shrink->width_px + (size_t)cover.first) * shrink->planes;

        for (size_t c = 0; c < channels; c++) {
            float value = values[c * width + (size_t)(shrink->part.x + x)];

            add_value(shrink, first + c, value, row_share * cover.first_share);
            if (cover.last != cover.first)
                add_value(shrink, first + shrink->planes + c, value, row_share * (1.0f - cover.first_share));
        }
    }
}

void view_shrink_add_line(struct view_shrink *shrink, int row, const float *values, size_t width)
{
    struct cover cover;

    if (row < shrink->part.y || row - shrink->part.y >= shrink->part.height_px) return;
    cover = find_cover(row - shrink->part.y, shrink->part.height_px, shrink->height_px);
    add_row(shrink, cover.first, values, width, cover.first_share);
    if (cover.last != cover.first) add_row(shrink, cover.last, values, width, 1.0f - cover.first_share);
}

float view_shrink_value(const struct view_shrink *shrink, size_t pixel, size_t channel)
{
    const float *sums = shrink->sums + pixel * shrink->planes;
    double covered =
        (double)shrink->part.width_px / shrink->width_px * ((double)shrink->part.height_px / shrink->height_px);

    if (shrink->kind == VIEW_SHRINK_DEPTH) return sums[1] > 0 ? sums[0] / sums[1] : 0.0f;
    return (float)((double)sums[shrink->kind == VIEW_SHRINK_THREE ? channel : 0] / covered);
}
