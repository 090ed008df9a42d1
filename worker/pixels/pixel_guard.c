// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_guard.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

// Points along a line, in steps of the lattice, lie this far apart.
static const double PITCH = 0.5;

static int clamp(double value, int limit)
{
    return value < 0.0 ? 0 : value > limit ? limit : (int)value;
}

static void mark_point(double x, double y, int reach, int columns, int rows, uint8_t *forced)
{
    double left = floor(x) - reach + 1.0, top = floor(y) - reach + 1.0, size = 2.0 * reach - 1.0;
    size_t first, last;

    if (!(left < columns && top < rows && left + size >= 0.0 && top + size >= 0.0)) return;
    first = (size_t)clamp(left, columns - 1);
    last = (size_t)clamp(left + size, columns - 1);
    for (int row = clamp(top, rows - 1); row <= clamp(top + size, rows - 1); row++)
        memset(forced + (size_t)row * (size_t)columns + first, 1, last - first + 1);
}

// Keeps the part of [begin, end] where `from` + t `by` is in [low, high]. Liang and Barsky, ACM Transactions on
// Graphics 3(1), 1984.
static bool clip(double from, double by, double low, double high, double *begin, double *end)
{
    double a, b;

    if (by == 0.0) return from >= low && from <= high;
    a = (low - from) / by;
    b = (high - from) / by;
    *begin = fmax(*begin, fmin(a, b));
    *end = fmin(*end, fmax(a, b));
    return *begin <= *end;
}

void pixel_guard_mark(const struct pixel_guard *guard, int stride, int columns, int rows, uint8_t *forced)
{
    double x = guard->from[0] / stride, y = guard->from[1] / stride, begin = 0.0, end = 1.0;
    double across = guard->to[0] / stride - x, down = guard->to[1] / stride - y, length = hypot(across, down);
    int count;

    if (!isfinite(x) || !isfinite(y) || !isfinite(length)) return;
    if (!clip(x, across, -guard->reach, columns + guard->reach, &begin, &end) ||
        !clip(y, down, -guard->reach, rows + guard->reach, &begin, &end))
        return;
    count = (int)ceil((end - begin) * length / PITCH);
    for (int i = 0; i <= count; i++) {
        double at = count > 0 ? begin + (double)i / count * (end - begin) : begin;

        mark_point(x + at * across, y + at * down, guard->reach, columns, rows, forced);
    }
}
