// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_lattice.h"

#include "core/base/alloc.h"
#include "worker/picture/image.h"
#include "worker/pixels/pixel_calm.h"
#include "worker/pixels/pixel_guard.h"
#include "worker/pixels/pixel_noise.h"
#include "worker/pixels/pixel_spread.h"
#include "worker/pixels/voxel_guards.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    REACH = 2, // points around a doubtful one that are traced, too
    RING = 2 * REACH + 1,
    MOST_DOUBT = 255,
    ROUGH = 255
};

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
    uint8_t *doubts, *roughness;
    uint8_t *forced; // by pixel_guard_mark and voxel_guards_mark; NULL: there are no guards
    struct pixel_spread colour, transmittance, paths;
    struct pixel_calm calm[2]; // of the last two rows of cells
    size_t surprise_count;     // of those of the level before: those of the rows so far
    float *doubt;              // of a row, between REACH zeros
    float *ring[RING];         // of the last rows, the largest of the points beside each
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
    lattice->roughness = xmalloc((size_t)lattice->columns * (size_t)lattice->rows);
    memset(lattice->roughness, ROUGH, (size_t)lattice->columns * (size_t)lattice->rows);
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
    free(lattice->roughness);
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
    if (lattice->params.has_noise && pixel_noise_explains(lattice->planes.transmittance + 4 * place, off)) return 0.0f;
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
        finer->planes =
            (struct pixel_planes){.rgba = image->rgba,
                                  .transmittance = image->transmittance,
                                  .paths = params->has_paths ? xmalloc(4 * count * sizeof(float)) : NULL,
                                  .depth = image->depth,
                                  .signatures = params->has_edges ? xmalloc(count * sizeof(uint32_t)) : NULL};
    }
    finer->doubts = xcalloc(count, 1);
    if (finer->stride > 1) finer->roughness = xmalloc(count);
    if (params->guard_count > 0 || params->voxels) finer->forced = xcalloc(count, 1);
    for (size_t i = 0; i < params->guard_count; i++)
        pixel_guard_mark(&params->guards[i], finer->stride, finer->columns, finer->rows, finer->forced);
    if (params->voxels) voxel_guards_mark(params->voxels, finer->stride, finer->columns, finer->rows, finer->forced);
    if (params->has_noise) pixel_noise_pool(planes->transmittance, lattice->columns, lattice->rows);
    pixel_spread_init(&finer->colour, planes->rgba, lattice->columns, lattice->rows, finer->columns);
    pixel_spread_init(&finer->transmittance, planes->transmittance, lattice->columns, lattice->rows, finer->columns);
    pixel_spread_init(&finer->paths, planes->paths, lattice->columns, lattice->rows, finer->columns);
    for (int i = 0; i < 2; i++)
        pixel_calm_init(&finer->calm[i], &(struct pixel_calm_params){.planes = &finer->before,
                                                                     .roughness = lattice->roughness,
                                                                     .columns = lattice->columns,
                                                                     .rows = lattice->rows,
                                                                     .forced = finer->forced,
                                                                     .finer_columns = finer->columns,
                                                                     .finer_rows = finer->rows});
    for (int c = 0; c < 4; c++) {
        finer->colour.scale[c] = c < 3 ? scale : whole;
        finer->transmittance.scale[c] = c < 3 && !params->has_noise ? whole : 0.0f;
    }
    finer->doubt = xcalloc((size_t)finer->columns + 2 * REACH, sizeof(float));
    finer->doubt += REACH;
    for (int i = 0; i < RING; i++)
        finer->ring[i] = xmalloc((size_t)finer->columns * sizeof(float));
}

// The new level takes the place of the old one.
static void end(struct refinement *finer)
{
    struct pixel_lattice *lattice = finer->lattice;

    pixel_planes_finish(&lattice->planes);
    free(lattice->doubts);
    free(lattice->roughness);
    lattice->planes = finer->planes;
    lattice->doubts = finer->doubts;
    lattice->roughness = finer->roughness;
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
    for (int i = 0; i < 2; i++)
        pixel_calm_finish(&finer->calm[i]);
    free(finer->doubt - REACH);
    for (int i = 0; i < RING; i++)
        free(finer->ring[i]);
}

// The points of a run of the new level, and `margin` beside it.
static struct pixel_run find_points(const struct refinement *finer, struct pixel_run run, int margin)
{
    int first = 2 * run.first - margin, end = 2 * run.end + margin;

    return (struct pixel_run){first > 0 ? first : 0, end < finer->columns ? end : finer->columns};
}

// The largest of each point of the new level and those up to REACH beside it. NaN, of light that is not finite, may be
// lost: the frame fails anyway.
static void widen(const float *doubt, struct pixel_run points, float *widened)
{
    for (int x = points.first; x < points.end; x++)
        widened[x] = most(most(most(doubt[x - 2], doubt[x - 1]), most(doubt[x + 1], doubt[x + 2])), doubt[x]);
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

static const struct pixel_calm *calm_of(const struct refinement *finer, int row)
{
    return &finer->calm[row / 2 % 2];
}

// Cells before and between the runs, and after the last one.
static struct pixel_run find_calm(const struct refinement *finer, const struct pixel_calm *calm, size_t i)
{
    return (struct pixel_run){i > 0 ? calm->runs[i - 1].end : 0,
                              i < calm->run_count ? calm->runs[i].first : finer->columns_before};
}

static void spread_plane(const struct refinement *finer, const struct pixel_spread *spread, int row, float *plane)
{
    const struct pixel_calm *calm = calm_of(finer, row);
    float *points = plane + 4 * (size_t)finer->columns * (size_t)row;

    for (size_t i = 0; i <= calm->run_count; i++) {
        pixel_spread_row_linear(spread, row, find_calm(finer, calm, i), points);
        if (i < calm->run_count) pixel_spread_row(spread, row, calm->runs[i], points, finer->doubt);
    }
}

// Bends that noise explains leave no doubt, but are none of a calm picture.
static void spread_noise(struct refinement *finer, int row)
{
    float *noise = finer->planes.transmittance + 4 * (size_t)finer->columns * (size_t)row;

    pixel_spread_row_linear(&finer->transmittance, row, (struct pixel_run){0, finer->columns_before}, noise);
    pixel_noise_lower(noise, finer->colour.scale[0], finer->columns, finer->doubt);
}

static void spread_row(struct refinement *finer, int row)
{
    const struct pixel_calm *calm = calm_of(finer, row);
    size_t size = (size_t)finer->columns * sizeof *finer->doubt;
    float *widened = finer->ring[row % RING];

    if (row % 2 == 0) pixel_calm_find(&finer->calm[row / 2 % 2], row / 2);
    memset(finer->doubt, 0, size);
    memset(widened, 0, size);
    spread_plane(finer, &finer->colour, row, finer->planes.rgba);
    if (finer->lattice->params.has_noise)
        spread_noise(finer, row);
    else if (finer->planes.transmittance)
        spread_plane(finer, &finer->transmittance, row, finer->planes.transmittance);
    if (finer->planes.paths)
        pixel_spread_row_linear(&finer->paths, row, (struct pixel_run){0, finer->columns_before},
                                finer->planes.paths + 4 * (size_t)finer->columns * (size_t)row);
    if (row % 2 == 0) add_surprises(finer, row / 2);
    for (size_t i = 0; i < calm->run_count; i++)
        widen(finer->doubt, find_points(finer, calm->runs[i], REACH), widened);
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
    return !planes->depth || !pixel_planes_are_apart(planes->depth[around->at[0]], planes->depth[around->at[1]],
                                                     planes->depth[around->at[2]], planes->depth[around->at[3]]);
}

static float find_depth(const struct pixel_planes *planes, struct around around)
{
    return 0.25f * (planes->depth[around.at[0]] + planes->depth[around.at[1]] + planes->depth[around.at[2]] +
                    planes->depth[around.at[3]]);
}

// `doubt`: coded.
static void interpolate(const struct refinement *finer, const struct around *around, size_t place, uint8_t doubt)
{
    const struct pixel_planes *planes = &finer->before;

    finer->doubts[place] = doubt;
    if (finer->roughness) finer->roughness[place] = doubt;
    if (finer->planes.signatures) finer->planes.signatures[place] = planes->signatures[around->at[0]];
    if (planes->depth) finer->planes.depth[place] = find_depth(planes, *around);
}

static void keep(const struct refinement *finer, size_t from, size_t place, uint8_t roughness)
{
    finer->doubts[place] = finer->doubts_before[from];
    if (finer->roughness) finer->roughness[place] = roughness;
    if (finer->planes.signatures) finer->planes.signatures[place] = finer->before.signatures[from];
    if (finer->before.depth) finer->planes.depth[place] = finer->before.depth[from];
}

static uint8_t code_doubt(float doubt)
{
    return doubt <= 1.0f ? (uint8_t)(1 + (int)(doubt * (MOST_DOUBT - 1))) : ROUGH;
}

// Decides which points of a run are traced: also those of the level before that were interpolated there and are
// doubtful here. The rows up to REACH after it have been spread.
static void decide(const struct refinement *finer, int row, struct pixel_run run)
{
    const struct refinement here = *finer; // which compilers know not to change when a doubt is stored
    size_t first = (size_t)row * (size_t)finer->columns;
    int top = row > REACH ? row - REACH : 0, bottom = row + REACH < finer->rows ? row + REACH : finer->rows - 1;
    const struct pixel_run points = find_points(finer, run, 0);
    float *doubt = finer->doubt;

    memcpy(doubt + points.first, finer->ring[top % RING] + points.first,
           (size_t)(points.end - points.first) * sizeof *doubt);
    for (int y = top + 1; y <= bottom; y++)
        for (int x = points.first; x < points.end; x++)
            doubt[x] = most(finer->ring[y % RING][x], doubt[x]);
    for (int x = points.first; x < points.end; x++) {
        struct around around = find_around(&here, x, row);
        size_t place = first + (size_t)x;

        if (x % 2 == 0 && row % 2 == 0 && (here.doubts_before[around.at[0]] == 0 || doubt[x] <= 1.0f)) {
            keep(&here, around.at[0], place, code_doubt(doubt[x]));
        } else if (!(doubt[x] <= 1.0f) || is_forced(&here, place, &around) || !is_same(&here.before, &around)) {
            pixel_lattice_want(here.lattice, (struct pixel){x * here.stride, row * here.stride}, place);
            if (here.roughness) here.roughness[place] = ROUGH;
        } else {
            interpolate(&here, &around, place, code_doubt(doubt[x]));
        }
    }
}

// Half the stride quarters what a smooth picture bends.
static uint8_t ease(uint8_t roughness)
{
    return (uint8_t)((roughness + 3) / 4);
}

static void glide(const struct refinement *finer, int row, struct pixel_run run)
{
    const struct refinement here = *finer;
    size_t from = (size_t)(row / 2) * (size_t)here.columns_before, to = (size_t)row * (size_t)here.columns;
    const uint8_t *roughness = here.lattice->roughness + from, *doubts = here.doubts_before + from;
    const uint32_t *signatures = here.before.signatures + from;
    const struct pixel_run points = find_points(finer, run, 0);

    for (int cell = run.first; cell < run.end; cell++) {
        size_t at = to + 2 * (size_t)cell;
        bool has_right = 2 * cell + 1 < here.columns;
        uint8_t eased = ease(roughness[cell]);

        if (2 * cell == here.columns) break;
        here.doubts[at] = row % 2 == 0 ? doubts[cell] : eased;
        if (has_right) here.doubts[at + 1] = eased;
        if (here.roughness) here.roughness[at] = eased;
        if (here.roughness && has_right) here.roughness[at + 1] = eased;
        if (here.planes.signatures) here.planes.signatures[at] = signatures[cell];
        if (here.planes.signatures && has_right) here.planes.signatures[at + 1] = signatures[cell];
    }
    if (!here.planes.depth) return;
    for (int x = points.first; x < points.end; x++)
        here.planes.depth[to + (size_t)x] = find_depth(&here.before, find_around(&here, x, row));
}

static void decide_row(const struct refinement *finer, int row)
{
    const struct pixel_calm *calm = calm_of(finer, row);

    for (size_t i = 0; i <= calm->run_count; i++) {
        glide(finer, row, find_calm(finer, calm, i));
        if (i < calm->run_count) decide(finer, row, calm->runs[i]);
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
