// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_lattice.h"

#include "core/base/alloc.h"
#include "worker/picture/image.h"
#include "worker/pixels/pixel_guard.h"
#include "worker/pixels/pixel_spread.h"
#include "worker/pixels/voxel_guards.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    REACH = 2, // points around a doubtful one that are traced, too
    RING = 2 * REACH + 1,
    MOST_DOUBT = 255
};

static const float APART = 0.02f;    // share of the smaller depth by which depths differ that are not interpolated
static const float SURPRISE = 0.25f; // share of a point's error by which the points around it are doubted
static const double LEAST_RMS = 1e-30;

// A level that is being made from the one before.
struct refinement {
    struct pixel_lattice *lattice;
    struct pixel_planes before; // of the level before, as are its doubts and columns
    const uint8_t *doubts_before;
    int columns_before;
    int stride, columns, rows; // of the new level
    struct pixel_planes planes;
    uint8_t *doubts;
    uint8_t *forced; // by pixel_guard_mark and voxel_guards_mark; NULL: there are no guards
    struct pixel_spread colour, transmittance, paths;
    size_t surprise_count;     // of those of the level before: those of the rows so far
    float *doubt, *ring[RING]; // of a row, and the largest of the points beside each, of the last rows
};

static int count_points(int size_px, int stride)
{
    return (size_px - 1 + stride - 1) / stride + 1;
}

static bool is_inside(const struct pixel_lattice *lattice, struct pixel pixel)
{
    return pixel.x < lattice->params.image->width_px && pixel.y < lattice->params.image->height_px;
}

void pixel_lattice_want(struct pixel_lattice *lattice, struct pixel pixel, size_t place)
{
    size_t count = lattice->wanted_count + 1;

    lattice->wanted = xgrow(lattice->wanted, &lattice->wanted_capacity, count, sizeof *lattice->wanted);
    lattice->places = xgrow(lattice->places, &lattice->place_capacity, count, sizeof *lattice->places);
    lattice->wanted[count - 1] = pixel;
    lattice->places[count - 1] = (uint32_t)place;
    lattice->wanted_count = count;
    if (is_inside(lattice, pixel)) lattice->traced++;
}

static struct pixel_channels channels_of(const struct pixel_lattice_params *params)
{
    return (struct pixel_channels){.has_transmittance = params->image->transmittance != NULL,
                                   .has_paths = params->has_paths,
                                   .has_depth = params->image->depth != NULL};
}

void pixel_lattice_init(struct pixel_lattice *lattice, const struct pixel_lattice_params *params)
{
    size_t place = 0;

    *lattice = (struct pixel_lattice){.params = *params,
                                      .stride = params->stride,
                                      .columns = count_points(params->image->width_px, params->stride),
                                      .rows = count_points(params->image->height_px, params->stride)};
    pixel_planes_init(&lattice->planes, channels_of(params), (size_t)lattice->columns * (size_t)lattice->rows);
    lattice->doubts = xcalloc((size_t)lattice->columns * (size_t)lattice->rows, 1);
    for (int row = 0; row < lattice->rows; row++)
        for (int column = 0; column < lattice->columns; column++)
            pixel_lattice_want(lattice, (struct pixel){column * params->stride, row * params->stride}, place++);
}

// The image owns these at stride 1.
static void disown(struct pixel_lattice *lattice)
{
    if (lattice->stride > 1) return;
    lattice->planes.rgba = lattice->planes.transmittance = lattice->planes.depth = NULL;
    lattice->doubts = NULL;
}

void pixel_lattice_finish(struct pixel_lattice *lattice)
{
    disown(lattice);
    pixel_planes_finish(&lattice->planes);
    free(lattice->doubts);
    free(lattice->forced);
    free(lattice->wanted);
    free(lattice->places);
    free(lattice->surprises);
    *lattice = (struct pixel_lattice){0};
}

static double find_rms(const struct pixel_lattice *lattice)
{
    double sum = 0.0, count = 0.0;

    for (size_t i = 0; i < lattice->wanted_count; i++) {
        const float *rgba = lattice->planes.rgba + 4 * (size_t)lattice->places[i];

        if (!is_inside(lattice, lattice->wanted[i])) continue;
        for (int c = 0; c < 3; c++)
            sum += (double)rgba[c] * rgba[c];
        count += 3.0;
    }
    return fmax(sqrt(sum / count), LEAST_RMS);
}

static float most(float a, float b)
{
    return a > b ? a : b;
}

// The doubt that a point's own error leaves about the points around it: how far it was from what it had been expected
// to show.
static float find_surprise(const struct pixel_lattice *lattice, size_t place, const float *traced)
{
    const float *expected = lattice->planes.rgba + 4 * place;
    float off = 0.0f;

    for (int c = 0; c < 3; c++)
        off = fmaxf(off, fabsf(traced[c] - expected[c]));
    return SURPRISE * off / (float)(lattice->params.threshold * lattice->rms);
}

void pixel_lattice_give(struct pixel_lattice *lattice, const struct pixel_planes *traced)
{
    bool is_first = lattice->rms == 0.0;

    lattice->surprise_count = is_first ? 0 : lattice->wanted_count;
    lattice->surprises = xrealloc(lattice->surprises, (lattice->wanted_count + 1) * sizeof *lattice->surprises);
    for (size_t i = 0; i < lattice->wanted_count; i++) {
        size_t place = lattice->places[i];

        if (!is_first)
            lattice->surprises[i] =
                (struct pixel_surprise){(uint32_t)place, find_surprise(lattice, place, traced->rgba + 4 * i)};
        pixel_planes_copy(&lattice->planes, place, traced, i);
    }
    if (is_first) lattice->rms = find_rms(lattice);
}

static void begin(struct refinement *finer, struct pixel_lattice *lattice)
{
    const struct pixel_lattice_params *params = &lattice->params;
    struct image *image = params->image;
    const struct pixel_planes *planes = &lattice->planes;
    float scale = (float)(1.0 / (params->threshold * lattice->rms)), whole = (float)(1.0 / params->threshold);
    size_t count;

    *finer = (struct refinement){.lattice = lattice,
                                 .before = lattice->planes,
                                 .doubts_before = lattice->doubts,
                                 .columns_before = lattice->columns,
                                 .stride = lattice->stride / 2};
    finer->columns = count_points(image->width_px, finer->stride);
    finer->rows = count_points(image->height_px, finer->stride);
    count = (size_t)finer->columns * (size_t)finer->rows;
    if (finer->stride > 1) {
        pixel_planes_init(&finer->planes, channels_of(params), count);
    } else {
        finer->planes = (struct pixel_planes){.rgba = image->rgba,
                                              .transmittance = image->transmittance,
                                              .paths = params->has_paths ? xmalloc(4 * count * sizeof(float)) : NULL,
                                              .depth = image->depth,
                                              .signatures = xmalloc(count * sizeof(uint32_t))};
    }
    finer->doubts = xcalloc(count, 1);
    if (params->guard_count > 0 || params->voxels) finer->forced = xcalloc(count, 1);
    for (size_t i = 0; i < params->guard_count; i++)
        pixel_guard_mark(&params->guards[i], finer->stride, finer->columns, finer->rows, finer->forced);
    if (params->voxels) voxel_guards_mark(params->voxels, finer->stride, finer->columns, finer->rows, finer->forced);
    pixel_spread_init(&finer->colour, planes->rgba, lattice->columns, lattice->rows, finer->columns);
    pixel_spread_init(&finer->transmittance, planes->transmittance, lattice->columns, lattice->rows, finer->columns);
    pixel_spread_init(&finer->paths, planes->paths, lattice->columns, lattice->rows, finer->columns);
    for (int c = 0; c < 4; c++) {
        finer->colour.scale[c] = c < 3 ? scale : whole;
        finer->transmittance.scale[c] = c < 3 ? whole : 0.0f;
    }
    finer->doubt = xmalloc((size_t)finer->columns * sizeof(float));
    for (int i = 0; i < RING; i++)
        finer->ring[i] = xmalloc((size_t)finer->columns * sizeof(float));
}

// The new level takes the place of the old one.
static void end(struct refinement *finer)
{
    struct pixel_lattice *lattice = finer->lattice;

    pixel_planes_finish(&lattice->planes);
    free(lattice->doubts);
    lattice->planes = finer->planes;
    lattice->doubts = finer->doubts;
    free(lattice->forced);
    lattice->forced = finer->forced;
    lattice->stride = finer->stride;
    lattice->columns = finer->columns;
    lattice->rows = finer->rows;
    if (lattice->stride == 1) {
        free(lattice->params.image->doubts);
        lattice->params.image->doubts = lattice->doubts;
    }
    pixel_spread_finish(&finer->colour);
    pixel_spread_finish(&finer->transmittance);
    pixel_spread_finish(&finer->paths);
    free(finer->doubt);
    for (int i = 0; i < RING; i++)
        free(finer->ring[i]);
}

// The largest of each point and those up to REACH beside it. NaN, of light that is not finite, may be lost: the frame
// fails anyway.
static void widen(const float *doubt, int count, float *widened)
{
    for (int x = 0; x < count; x++)
        widened[x] = doubt[x];
    for (int away = 1; away <= REACH; away++) {
        for (int x = 0; x + away < count; x++)
            widened[x] = most(widened[x], doubt[x + away]);
        for (int x = away; x < count; x++)
            widened[x] = most(widened[x], doubt[x - away]);
    }
}

// The surprises of a row of the level before are in the order of its columns.
static void add_surprises(struct refinement *finer, int row)
{
    const struct pixel_lattice *lattice = finer->lattice;
    uint32_t columns = (uint32_t)lattice->columns;

    for (; finer->surprise_count < lattice->surprise_count; finer->surprise_count++) {
        const struct pixel_surprise *surprise = &lattice->surprises[finer->surprise_count];
        uint32_t column = 2 * (surprise->place % columns);

        if (surprise->place / columns != (uint32_t)row) break;
        if (column < (uint32_t)finer->columns) finer->doubt[column] = most(surprise->doubt, finer->doubt[column]);
    }
}

static void spread_row(struct refinement *finer, int row)
{
    size_t at = 4 * (size_t)finer->columns * (size_t)row;

    memset(finer->doubt, 0, (size_t)finer->columns * sizeof *finer->doubt);
    pixel_spread_row(&finer->colour, row, finer->planes.rgba + at, finer->doubt);
    if (finer->planes.transmittance)
        pixel_spread_row(&finer->transmittance, row, finer->planes.transmittance + at, finer->doubt);
    if (finer->planes.paths) pixel_spread_row_linear(&finer->paths, row, finer->planes.paths + at);
    if (row % 2 == 0) add_surprises(finer, row / 2);
    widen(finer->doubt, finer->columns, finer->ring[row % RING]);
}

// The points of the level before around one of the new level: one, two or four of them.
struct around {
    size_t at[4];
};

static struct around find_around(const struct refinement *finer, int column, int row)
{
    size_t columns = (size_t)finer->columns_before, at = (size_t)(row / 2) * columns + (size_t)(column / 2);
    size_t right = column % 2 == 1 ? 1 : 0, below = row % 2 == 1 ? columns : 0;

    return (struct around){{at, at + right, at + below, at + right + below}};
}

static bool is_apart(const float *depth, const struct around *around)
{
    float low = INFINITY, high = 0.0f;

    for (int i = 0; i < 4; i++) {
        low = depth[around->at[i]] < low ? depth[around->at[i]] : low;
        high = most(depth[around->at[i]], high);
    }
    return !(high - low <= APART * low);
}

static bool is_clear(const struct pixel_planes *planes, const struct around *around)
{
    uint32_t met = 0;

    for (int i = 0; i < 4; i++)
        met |= planes->signatures[around->at[i]];
    return (met & 1) == 0;
}

static bool is_forced(const struct refinement *finer, size_t place, const struct around *around)
{
    if (!finer->forced || finer->forced[place] == 0) return false;
    return finer->forced[place] != VOXEL_GUARD_IN_THE_CLEAR || is_clear(&finer->before, around);
}

static bool is_same(const struct pixel_planes *planes, const struct around *around)
{
    const uint32_t *signatures = planes->signatures;
    uint32_t first = signatures[around->at[0]];

    if (signatures[around->at[1]] != first || signatures[around->at[2]] != first || signatures[around->at[3]] != first)
        return false;
    return !planes->depth || !is_apart(planes->depth, around);
}

static void interpolate(const struct refinement *finer, const struct around *around, size_t place, float doubt)
{
    const struct pixel_planes *planes = &finer->before;
    float coded = doubt * (MOST_DOUBT - 1);

    finer->doubts[place] = (uint8_t)(1 + (int)coded);
    finer->planes.signatures[place] = planes->signatures[around->at[0]];
    if (!planes->depth) return;
    finer->planes.depth[place] = 0.25f * (planes->depth[around->at[0]] + planes->depth[around->at[1]] +
                                          planes->depth[around->at[2]] + planes->depth[around->at[3]]);
}

static void keep(const struct refinement *finer, size_t from, size_t place)
{
    finer->doubts[place] = finer->doubts_before[from];
    finer->planes.signatures[place] = finer->before.signatures[from];
    if (finer->before.depth) finer->planes.depth[place] = finer->before.depth[from];
}

// Decides which points of a row are traced: also those of the level before that were interpolated there and are
// doubtful here. The rows up to REACH after it have been spread.
static void decide_row(struct refinement *finer, int row)
{
    const struct refinement here = *finer; // which compilers know not to change when a doubt is stored
    size_t first = (size_t)row * (size_t)finer->columns;
    int top = row > REACH ? row - REACH : 0, bottom = row + REACH < finer->rows ? row + REACH : finer->rows - 1;
    float *doubt = finer->doubt;

    memcpy(doubt, finer->ring[top % RING], (size_t)finer->columns * sizeof *doubt);
    for (int y = top + 1; y <= bottom; y++)
        for (int x = 0; x < finer->columns; x++)
            doubt[x] = most(finer->ring[y % RING][x], doubt[x]);
    for (int x = 0; x < here.columns; x++) {
        struct around around = find_around(&here, x, row);
        size_t place = first + (size_t)x;

        if (x % 2 == 0 && row % 2 == 0 && (here.doubts_before[around.at[0]] == 0 || doubt[x] <= 1.0f))
            keep(&here, around.at[0], place);
        else if (!(doubt[x] <= 1.0f) || is_forced(&here, place, &around) || !is_same(&here.before, &around))
            pixel_lattice_want(here.lattice, (struct pixel){x * here.stride, row * here.stride}, place);
        else
            interpolate(&here, &around, place, doubt[x]);
    }
}

bool pixel_lattice_refine(struct pixel_lattice *lattice)
{
    struct refinement finer;

    lattice->wanted_count = 0;
    if (lattice->stride == 1) return false;
    begin(&finer, lattice);
    for (int row = 0; row < finer.rows + REACH; row++) {
        if (row < finer.rows) spread_row(&finer, row);
        if (row >= REACH) decide_row(&finer, row - REACH);
    }
    lattice->surprise_count = 0;
    end(&finer);
    return true;
}
