// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_spread.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

// Compilers use SIMD units for these.
typedef float floats __attribute__((vector_size(16)));
typedef int mask __attribute__((vector_size(16)));

static floats load(const float *from)
{
    floats loaded;

    memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

static void store(float *to, floats stored)
{
    memcpy(to, &stored, sizeof stored);
}

static floats choose(mask first, floats a, floats b)
{
    return (floats)((first & (mask)a) | (~first & (mask)b));
}

static floats least(floats a, floats b)
{
    return choose(a < b, a, b);
}

static floats most(floats a, floats b)
{
    return choose(a > b, a, b);
}

// Half way between b and c, of a, b, c and d. `bend`: an eighth of the larger second difference, by which a straight
// line is off where that is constant.
struct between {
    floats cubic, bend;
};

static inline floats find_bend(floats a, floats b, floats c)
{
    floats difference = a - 2.0f * b + c;

    return 0.125f * most(difference, -difference);
}

static inline struct between find_between_four(floats a, floats b, floats c, floats d)
{
    floats cubic = (9.0f * (b + c) - (a + d)) * 0.0625f;

    return (struct between){least(most(cubic, least(least(a, b), least(c, d))), most(most(a, b), most(c, d))),
                            most(find_bend(a, b, c), find_bend(b, c, d))};
}

// The same where `a` or `d` lies beyond the edge and is unknown. The range is that of the points there are.
static struct between find_between_at_edge(floats a, floats b, floats c, floats d, bool has_a, bool has_d)
{
    floats low = least(b, c), high = most(b, c), before = a, after = d, bend = {0};

    if (has_a) low = least(low, a), high = most(high, a), bend = find_bend(a, b, c);
    if (has_d) low = least(low, d), high = most(high, d), bend = most(bend, find_bend(b, c, d));
    if (!has_a) before = has_d ? 3.0f * (b - c) + d : 2.0f * b - c;
    if (!has_d) after = has_a ? 3.0f * (c - b) + a : 2.0f * c - b;
    return (struct between){least(most((9.0f * (b + c) - (before + after)) * 0.0625f, low), high), bend};
}

void pixel_spread_init(struct pixel_spread *spread, const float *values, int columns, int rows, int finer_columns)
{
    *spread = (struct pixel_spread){.values = values,
                                    .columns = columns,
                                    .rows = rows,
                                    .finer_columns = finer_columns,
                                    .cubic = xmalloc(4 * (size_t)columns * sizeof(float)),
                                    .bend = xmalloc(4 * (size_t)columns * sizeof(float))};
}

void pixel_spread_finish(struct pixel_spread *spread)
{
    free(spread->cubic);
    free(spread->bend);
    *spread = (struct pixel_spread){0};
}

static const float *row_of(const struct pixel_spread *spread, int row)
{
    return spread->values + 4 * (size_t)spread->columns * (size_t)row;
}

// Interpolates down the columns, between rows `y` and `y` + 1 of the lattice.
static void spread_down(const struct pixel_spread *spread, int y)
{
    bool has_a = y > 0, has_d = y + 2 < spread->rows;
    const float *b = row_of(spread, y), *c = row_of(spread, y + 1);
    const float *a = has_a ? row_of(spread, y - 1) : b, *d = has_d ? row_of(spread, y + 2) : c;

    for (size_t i = 0; i < 4 * (size_t)spread->columns; i += 4) {
        struct between between =
            has_a && has_d ? find_between_four(load(a + i), load(b + i), load(c + i), load(d + i))
                           : find_between_at_edge(load(a + i), load(b + i), load(c + i), load(d + i), has_a, has_d);

        store(spread->cubic + i, between.cubic);
        store(spread->bend + i, between.bend);
    }
}

static float find_doubt(floats bend, floats scale)
{
    floats off = bend * scale;
    float first = off[0] > off[1] ? off[0] : off[1], second = off[2] > off[3] ? off[2] : off[3];

    return first > second ? first : second;
}

static void note(float *doubt, float found)
{
    *doubt = *doubt >= found ? *doubt : found; // NaN is kept, and then doubted
}

static struct between find_between(const float *row, int column, int columns)
{
    const float *b = row + 4 * (size_t)column;
    bool has_a = column > 0, has_d = column + 2 < columns;

    if (has_a && has_d) return find_between_four(load(b - 4), load(b), load(b + 4), load(b + 8));
    return find_between_at_edge(has_a ? load(b - 4) : load(b), load(b), load(b + 4), has_d ? load(b + 8) : load(b + 4),
                                has_a, has_d);
}

void pixel_spread_row(const struct pixel_spread *spread, int row, float *finer, float *doubt)
{
    bool is_between = row % 2 == 1;
    const float *cubic = is_between ? spread->cubic : row_of(spread, row / 2);
    floats scale = load(spread->scale);

    if (is_between) spread_down(spread, row / 2);
    for (int x = 0; x < spread->finer_columns; x += 2) {
        size_t at = 2 * (size_t)x;
        struct between between;

        store(finer + 2 * at, load(cubic + at));
        if (doubt && is_between) note(&doubt[x], find_doubt(load(spread->bend + at), scale));
        if (x + 1 == spread->finer_columns) break;
        between = find_between(cubic, x / 2, spread->columns);
        store(finer + 2 * at + 4, between.cubic);
        if (doubt) note(&doubt[x + 1], find_doubt(between.bend, scale));
    }
}

void pixel_spread_row_linear(const struct pixel_spread *spread, int row, float *finer)
{
    const float *upper = row_of(spread, row / 2), *lower = row % 2 == 1 ? row_of(spread, row / 2 + 1) : upper;

    for (int x = 0; x < spread->finer_columns; x += 2) {
        size_t at = 2 * (size_t)x;
        floats here = 0.5f * (load(upper + at) + load(lower + at));

        store(finer + 2 * at, here);
        if (x + 1 == spread->finer_columns) break;
        store(finer + 2 * at + 4, 0.5f * (here + 0.5f * (load(upper + at + 4) + load(lower + at + 4))));
    }
}
