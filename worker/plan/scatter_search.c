// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_search.h"

#include <math.h>

const int scatter_grid_cells[SCATTER_GRID_RUNGS] = {4, 6, 8, 11, 16, 22, 32, 45, 64, 90, 128, 181, 256};

enum {
    GRID_FIRST = 4,       // 16 cells
    GRID_GUESSED = 10,    // 128 cells: no finer grid is chosen untried, since it may take too much memory
    PATHS_FIRST = 4,      // 16 paths of each node,
    PIXEL_PATHS_FIRST = 7 // and 128 of each pixel
};

// The share of the target's square that a grid's cells may take: the rest is for the paths.
static const double CELLS_SHARE = 0.7;
// Of all paths that may be traced, those of one measurement of a grid: finer grids are to have their turn.
static const double GRID_PART = 0.25;
// Of a squared error, what is noise at least: two measurements may agree by chance.
static const double NOISE_LEAST = 0.1;
// Linear interpolation's squared error falls by no higher power of the number of cells.
static const double STEEPEST = 4.0;

struct walk {
    const struct scatter_search *search;
    struct scatter_finding finding;
    double cost, traced; // of the finding; by all measurements
    double least;        // the least square that was met
    bool is_dear;        // no grid was found cheaply
    // The finest grid whose cells alone were too much; 0 cells: none yet.
    int coarse_rung;
    double coarse_cells;
    // The noise of one path of each node, times the number of cells along a side, as pixels see nodes along a ray: the
    // largest of all grids that were tried.
    double noise;
};

static double nodes_of(const struct walk *walk, int grid_rung)
{
    return grid_rung == SCATTER_PIXELS ? walk->search->pixels : pow(scatter_grid_cells[grid_rung], 3.0);
}

static bool measure(struct walk *walk, int grid_rung, int path_rung, double *square)
{
    double nodes = grid_rung == SCATTER_PIXELS ? walk->search->list_pixels : nodes_of(walk, grid_rung);

    walk->traced += nodes * exp2(path_rung);
    if (walk->search->measure(walk->search->user, grid_rung, path_rung, square)) return true;
    walk->finding.is_stopped = true;
    return false;
}

static bool has_found_grid(const struct walk *walk)
{
    return walk->finding.is_found && walk->finding.grid_rung != SCATTER_PIXELS;
}

// True while a measurement with so many paths is affordable. Where a frame takes many paths by all that is known, a
// share of them is spent on finding something cheaper.
static bool is_affordable(const struct walk *walk, int grid_rung, int path_rung)
{
    static const double SHARE_OF_FRAME = 0.25;
    double nodes = grid_rung == SCATTER_PIXELS ? walk->search->list_pixels : nodes_of(walk, grid_rung);
    double most = walk->search->path_max, paths = nodes * exp2(path_rung);

    if (walk->is_dear && isfinite(walk->cost)) most = fmax(most, SHARE_OF_FRAME * walk->cost);
    if (path_rung >= SCATTER_PATH_RUNGS || walk->traced + paths > most) return false;
    return grid_rung == SCATTER_PIXELS || paths <= GRID_PART * most;
}

static void keep(struct walk *walk, int grid_rung, int path_rung, double square)
{
    double cost = nodes_of(walk, grid_rung) * exp2(path_rung), target = walk->search->target;
    bool is_within = square <= target * target;

    if (walk->finding.is_found ? !is_within || cost >= walk->cost : !is_within && square >= walk->least) return;
    walk->finding.grid_rung = grid_rung;
    walk->finding.path_rung = path_rung;
    walk->finding.error = sqrt(fmax(square, 0.0));
    walk->finding.is_found = is_within;
    walk->cost = cost;
    walk->least = square;
}

// The parts of a squared error that paths leave, and that the grid's cells do.
struct parts {
    double noise, cells;
    double fallen; // the noise by the measurements' difference alone
};

// The noise of a grid as other grids tell it; 0 before they do.
static double expect_noise(const struct walk *walk, int grid_rung, int path_rung)
{
    return walk->noise / scatter_grid_cells[grid_rung] * exp2(-path_rung);
}

// `coarse` was measured with so many rungs of paths fewer than `fine`: the more, the less does chance in what they are
// compared with count. They may agree by chance, which looks like the error of cells: what is noise by other grids,
// `expected`, is not theirs.
static struct parts split(double coarse, double fine, int rungs, double expected)
{
    double fallen = fmax((coarse - fine) / (exp2(rungs) - 1.0), 0.0);
    double noise = fmax(fallen, NOISE_LEAST * fmax(fine, 0.0));

    return (struct parts){.noise = noise, .cells = fmax(fine - fmax(noise, expected), 0.0), .fallen = fallen};
}

// Paths of pixels have noise alone, which follows from the mean variance of all paths that were traced.
static struct parts find_pixel_noise(double coarse, double fine, int rungs)
{
    static const double LEAST = 0.5;
    double noise = (coarse * exp2(-2.0 * rungs) + fine) / (1.0 + exp2(-rungs));

    return (struct parts){.noise = fmax(noise, LEAST * coarse * exp2(-rungs))};
}

// By how many rungs paths leave no more than `allowed` of the noise.
static int find_rungs(double noise, double allowed, int path_rung)
{
    int by = noise > 0.0 ? (int)ceil(log2(noise / allowed)) : -path_rung;

    if (path_rung + by < 0) return -path_rung;
    return path_rung + by < SCATTER_PATH_RUNGS ? by : SCATTER_PATH_RUNGS - 1 - path_rung;
}

// What a grid's cells add at least, as coarser ones tell.
static double least_cells(const struct walk *walk, int grid_rung)
{
    double ratio = (double)scatter_grid_cells[walk->coarse_rung] / scatter_grid_cells[grid_rung];

    return ratio < 1.0 ? walk->coarse_cells * pow(ratio, STEEPEST) : 0.0;
}

static void note_grid(struct walk *walk, int grid_rung, int path_rung, const struct parts *parts)
{
    double wanted = walk->search->target * walk->search->target;

    walk->noise = fmax(walk->noise, parts->fallen * exp2(path_rung) * scatter_grid_cells[grid_rung]);
    if (parts->cells <= CELLS_SHARE * wanted) return;
    walk->coarse_rung = grid_rung;
    walk->coarse_cells = parts->cells / (1.0 - NOISE_LEAST);
}

// Where all grids that could be tried are too coarse, chooses one from `rung` on by what they tell.
static void guess_grid(struct walk *walk, int rung)
{
    double wanted = walk->search->target * walk->search->target;

    for (; walk->coarse_cells > 0.0 && rung <= GRID_GUESSED; rung++) {
        double cells = least_cells(walk, rung);
        double noise = expect_noise(walk, rung, 0);
        int paths;

        if (cells > CELLS_SHARE * wanted) continue;
        paths = find_rungs(noise, wanted - cells, 0);
        keep(walk, rung, paths, cells + noise * exp2(-paths));
        return;
    }
}

// True where the cells alone are over their share, and so much that chance does not matter.
static bool is_too_coarse(const struct parts *parts, double wanted)
{
    return parts->cells > wanted + parts->noise;
}

// Tries one grid. Paths are quadrupled until their noise is within the target, or they are too many, or do not matter.
static bool try_grid(struct walk *walk, int grid_rung, int path_rung, struct parts *parts)
{
    double wanted = walk->search->target * walk->search->target, coarse, fine;
    int first = path_rung, by = 0;

    *parts = (struct parts){.noise = INFINITY};
    if (!measure(walk, grid_rung, path_rung, &coarse)) return false;
    while (parts->noise > wanted && !is_too_coarse(parts, wanted) && is_affordable(walk, grid_rung, path_rung + 2)) {
        if (!measure(walk, grid_rung, path_rung + 2, &fine)) return false;
        if (isinf(fine)) break;
        path_rung += 2;
        if (grid_rung == SCATTER_PIXELS) { // their noise is known by then
            *parts = find_pixel_noise(coarse, fine, path_rung - first);
            break;
        }
        *parts = split(coarse, fine, path_rung - first, expect_noise(walk, grid_rung, path_rung));
    }
    if (isinf(parts->noise)) return true;
    if (grid_rung != SCATTER_PIXELS) note_grid(walk, grid_rung, path_rung, parts);
    if (parts->cells <= CELLS_SHARE * wanted) by = find_rungs(parts->noise, wanted - parts->cells, path_rung);
    keep(walk, grid_rung, path_rung + by, parts->cells + parts->noise * exp2(-by));
    return true;
}

// By how many rungs cells have to be finer. Their squared error falls with the fourth power of their size where light
// is smooth, and not as quickly elsewhere: one rung less than that.
static int find_finer(const struct walk *walk, const struct parts *parts, int grid_rung)
{
    double allowed = CELLS_SHARE * walk->search->target * walk->search->target;
    int by = parts->cells > allowed ? (int)(log2(parts->cells / allowed) / 2.0) : 1;

    while (by > 1 && (grid_rung + by >= SCATTER_GRID_RUNGS || !is_affordable(walk, grid_rung + by, PATHS_FIRST + 2)))
        by--;
    return by > 1 ? by : 1;
}

// Finer grids from *rung on, until one keeps the target and the next costs more. *rung becomes the first that was not
// tried.
static bool try_finer(struct walk *walk, int *rung)
{
    struct parts parts;

    while (*rung < SCATTER_GRID_RUNGS && is_affordable(walk, *rung, PATHS_FIRST + 2)) {
        int tried = *rung;

        if (!try_grid(walk, tried, PATHS_FIRST, &parts)) return false;
        *rung += find_finer(walk, &parts, tried);
        if (has_found_grid(walk) && walk->finding.grid_rung < tried) break;
    }
    return true;
}

static bool try_coarser(struct walk *walk)
{
    int before = walk->finding.grid_rung;
    struct parts parts;

    for (int rung = before - 1; rung >= 0 && walk->finding.is_found && before == rung + 1; rung--) {
        if (!try_grid(walk, rung, PATHS_FIRST, &parts)) return false;
        before = walk->finding.grid_rung;
    }
    return true;
}

static bool try_all(struct walk *walk)
{
    int rung = GRID_FIRST;
    struct parts parts;

    if (walk->search->has_grid && !try_finer(walk, &rung)) return false;
    // Pixels cannot need fewer paths than one each.
    if (!has_found_grid(walk) || walk->cost > walk->search->pixels)
        if (!try_grid(walk, SCATTER_PIXELS, PIXEL_PATHS_FIRST, &parts)) return false;
    if (!walk->search->has_grid) return true;
    if (has_found_grid(walk)) return try_coarser(walk);
    guess_grid(walk, rung);
    walk->is_dear = true;
    return try_finer(walk, &rung);
}

struct scatter_finding scatter_search_run(const struct scatter_search *search)
{
    struct walk walk = {.search = search,
                        .finding = {.grid_rung = SCATTER_PIXELS, .path_rung = PIXEL_PATHS_FIRST, .error = INFINITY},
                        .cost = INFINITY,
                        .least = INFINITY};

    (void)try_all(&walk);
    return walk.finding;
}
