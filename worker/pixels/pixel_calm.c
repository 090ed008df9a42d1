// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_calm.h"

#include "core/base/alloc.h"
#include "worker/pixels/pixel_planes.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// The points from whose values a cell's are interpolated lie up to two away, and a ray at one of them also changes what
// lies between it and the next.
enum { REACH = 3, ROUGH = 255 };

void pixel_calm_init(struct pixel_calm *calm, const struct pixel_calm_params *params)
{
    size_t columns = (size_t)params->columns;

    *calm = (struct pixel_calm){.params = *params,
                                .rough = xmalloc(columns),
                                .wide = xmalloc(columns),
                                .runs = xmalloc((columns / 2 + 1) * sizeof *calm->runs)};
}

void pixel_calm_finish(struct pixel_calm *calm)
{
    free(calm->rough);
    free(calm->wide);
    free(calm->runs);
    *calm = (struct pixel_calm){0};
}

static uint8_t most(uint8_t a, uint8_t b)
{
    return a > b ? a : b;
}

static void gather(const struct pixel_calm *calm, int row)
{
    const struct pixel_calm_params *params = &calm->params;
    int columns = params->columns, top = row > REACH ? row - REACH : 0, bottom = row + 1 + REACH;
    uint8_t *rough = calm->rough, *wide = calm->wide;

    if (bottom > params->rows - 1) bottom = params->rows - 1;
    memcpy(rough, params->roughness + (size_t)top * (size_t)columns, (size_t)columns);
    for (int y = top + 1; y <= bottom; y++) {
        const uint8_t *other = params->roughness + (size_t)y * (size_t)columns;

        for (int x = 0; x < columns; x++)
            rough[x] = most(rough[x], other[x]);
    }
    memcpy(wide, rough, (size_t)columns);
    for (int away = 1; away <= REACH + 1; away++) {
        for (int x = 0; x + away < columns; x++)
            wide[x] = most(wide[x], rough[x + away]);
        for (int x = away; x < columns && away <= REACH; x++)
            wide[x] = most(wide[x], rough[x - away]);
    }
}

static void add_signatures(const struct pixel_calm *calm, size_t at, size_t below)
{
    const uint32_t *upper = calm->params.planes->signatures + at, *lower = upper + below;
    int last = calm->params.columns - 1;

    for (int x = 0; x < last; x++)
        if (upper[x] != upper[x + 1] || upper[x] != lower[x] || upper[x] != lower[x + 1]) calm->wide[x] = ROUGH;
    if (upper[last] != lower[last]) calm->wide[last] = ROUGH;
}

static void add_depths(const struct pixel_calm *calm, size_t at, size_t below)
{
    const float *upper = calm->params.planes->depth + at, *lower = upper + below;

    for (int x = 0; x < calm->params.columns; x++) {
        int right = x + 1 < calm->params.columns ? x + 1 : x;

        if (pixel_planes_are_apart(upper[x], upper[right], lower[x], lower[right])) calm->wide[x] = ROUGH;
    }
}

static void add_guards(const struct pixel_calm *calm, int row)
{
    const struct pixel_calm_params *params = &calm->params;
    int columns = params->finer_columns;

    for (int y = 2 * row; y < 2 * row + 2 && y < params->finer_rows; y++) {
        const uint8_t *forced = params->forced + (size_t)y * (size_t)columns;

        for (int x = 0; x + 1 < columns; x += 2)
            if ((forced[x] | forced[x + 1]) != 0) calm->wide[x / 2] = ROUGH;
        if (columns % 2 == 1 && forced[columns - 1] != 0) calm->wide[columns / 2] = ROUGH;
    }
}

void pixel_calm_find(struct pixel_calm *calm, int row)
{
    const struct pixel_calm_params *params = &calm->params;
    size_t at = (size_t)row * (size_t)params->columns, below = row + 1 < params->rows ? (size_t)params->columns : 0;
    const uint8_t *wide = calm->wide;

    gather(calm, row);
    add_signatures(calm, at, below);
    if (params->planes->depth) add_depths(calm, at, below);
    if (params->forced) add_guards(calm, row);
    calm->run_count = 0;
    for (int x = 0; x < params->columns; x++) {
        if (wide[x] <= PIXEL_CALM_MOST) continue;
        calm->runs[calm->run_count].first = x;
        while (x < params->columns && wide[x] > PIXEL_CALM_MOST)
            x++;
        calm->runs[calm->run_count++].end = x;
    }
}
