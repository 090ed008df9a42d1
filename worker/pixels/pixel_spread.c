// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_spread.h"

#include "core/base/alloc.h"
#include "worker/picture/four.h"

#include <stdlib.h>

// Half way between b and c, of a, b, c and d. `bend`: an eighth of the larger second difference, by which a straight
// line is off where that is constant.
struct between {
    four cubic, bend;
};

static inline four find_bend(four a, four b, four c)
{
    four difference = a - 2.0f * b + c;

    return 0.125f * four_most(difference, -difference);
}

static inline struct between find_between_four(four a, four b, four c, four d)
{
    four cubic = (9.0f * (b + c) - (a + d)) * 0.0625f;
    four low = four_least(four_least(a, b), four_least(c, d)), high = four_most(four_most(a, b), four_most(c, d));

    return (struct between){four_least(four_most(cubic, low), high), four_most(find_bend(a, b, c), find_bend(b, c, d))};
}

// The same where `a` or `d` lies beyond the edge and is unknown. The range is that of the points there are.
static struct between find_between_at_edge(four a, four b, four c, four d, bool has_a, bool has_d)
{
    four low = four_least(b, c), high = four_most(b, c), before = a, after = d, bend = {0};

    if (has_a) low = four_least(low, a), high = four_most(high, a), bend = find_bend(a, b, c);
    if (has_d) low = four_least(low, d), high = four_most(high, d), bend = four_most(bend, find_bend(b, c, d));
    if (!has_a) before = has_d ? 3.0f * (b - c) + d : 2.0f * b - c;
    if (!has_d) after = has_a ? 3.0f * (c - b) + a : 2.0f * c - b;
    return (struct between){four_least(four_most((9.0f * (b + c) - (before + after)) * 0.0625f, low), high), bend};
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

// Interpolates down the columns of a run and those that its cubics take, between rows `y` and `y` + 1 of the lattice.
static void spread_down(const struct pixel_spread *spread, int y, struct pixel_run run)
{
    int first = run.first > 0 ? run.first - 1 : 0, end = run.end + 2 < spread->columns ? run.end + 2 : spread->columns;
    bool has_a = y > 0, has_d = y + 2 < spread->rows;
    const float *b = row_of(spread, y), *c = row_of(spread, y + 1);
    const float *a = has_a ? row_of(spread, y - 1) : b, *d = has_d ? row_of(spread, y + 2) : c;

    for (size_t i = 4 * (size_t)first; i < 4 * (size_t)end; i += 4) {
        struct between between =
            has_a && has_d ? find_between_four(four_load(a + i), four_load(b + i), four_load(c + i), four_load(d + i))
                           : find_between_at_edge(four_load(a + i), four_load(b + i), four_load(c + i),
                                                  four_load(d + i), has_a, has_d);

        four_store(spread->cubic + i, between.cubic);
        four_store(spread->bend + i, between.bend);
    }
}

static float find_doubt(four bend, four scale)
{
    return four_largest(bend * scale);
}

// Light that is not finite fails its frame, whatever is doubted around it.
static void note(float *doubt, float found)
{
    *doubt = found > *doubt ? found : *doubt;
}

static struct between find_between(const float *row, int column, int columns)
{
    const float *b = row + 4 * (size_t)column;
    bool has_a = column > 0, has_d = column + 2 < columns;

    if (has_a && has_d) return find_between_four(four_load(b - 4), four_load(b), four_load(b + 4), four_load(b + 8));
    return find_between_at_edge(has_a ? four_load(b - 4) : four_load(b), four_load(b), four_load(b + 4),
                                has_d ? four_load(b + 8) : four_load(b + 4), has_a, has_d);
}

// The column after a run's last point of the finer lattice.
static int find_end(const struct pixel_spread *spread, struct pixel_run run)
{
    return 2 * run.end < spread->finer_columns ? 2 * run.end : spread->finer_columns;
}

void pixel_spread_row(const struct pixel_spread *spread, int row, struct pixel_run run, float *finer, float *doubt)
{
    bool is_between = row % 2 == 1;
    int end = find_end(spread, run);
    const float *cubic = is_between ? spread->cubic : row_of(spread, row / 2);
    four scale = four_load(spread->scale);

    if (is_between) spread_down(spread, row / 2, run);
    for (int x = 2 * run.first; x < end; x += 2) {
        size_t at = 2 * (size_t)x;
        struct between between;

        four_store(finer + 2 * at, four_load(cubic + at));
        if (doubt && is_between) note(&doubt[x], find_doubt(four_load(spread->bend + at), scale));
        if (x + 1 == end) break;
        between = find_between(cubic, x / 2, spread->columns);
        four_store(finer + 2 * at + 4, between.cubic);
        if (doubt) note(&doubt[x + 1], find_doubt(between.bend, scale));
    }
}

void pixel_spread_row_linear(const struct pixel_spread *spread, int row, struct pixel_run run, float *finer)
{
    const float *upper = row_of(spread, row / 2), *lower = row % 2 == 1 ? row_of(spread, row / 2 + 1) : upper;
    int end = find_end(spread, run);
    size_t at = 4 * (size_t)run.first;
    four here, next;

    if (2 * run.first >= end) return; // the row may end here
    next = 0.5f * (four_load(upper + at) + four_load(lower + at));
    for (int x = 2 * run.first; x < end; x += 2) {
        at = 2 * (size_t)x;
        here = next;
        four_store(finer + 2 * at, here);
        if (x + 1 == end) break;
        next = 0.5f * (four_load(upper + at + 4) + four_load(lower + at + 4));
        four_store(finer + 2 * at + 4, 0.5f * (here + next));
    }
}
