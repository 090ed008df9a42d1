// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_search.h"

#include <math.h>

const int scatter_grid_cells[SCATTER_GRID_RUNGS] = {4, 6, 8, 11, 16, 22, 32, 45, 64, 90, 128, 181, 256};

enum {
    GRID_FIRST = 4,         // 16 cells
    GRID_GUESSED = 10,      // 128 cells: no finer grid is chosen untried, since it may take too much memory
    PATHS_FIRST = 8,        // 16 paths of each node,
    PIXEL_PATHS_FIRST = 14, // and 128 of each pixel
    FOURFOLD = 4
};

// The share of the target's square that a grid's cells may take: the rest is for the paths.
static const double CELLS_SHARE = 0.7;
// Of all paths that may be traced, those of one measurement of a grid: finer grids are to have their turn.
static const double GRID_PART = 0.5;
// Linear interpolation's squared error falls by no higher power of the number of cells.
static const double STEEPEST = 4.0;
// That by which it mostly falls, and the standard deviation of what this foretells, relative to it.
static const double USUAL = 2.5, USUAL_SPREAD = 0.5;
// Chance that hides cells, in squares of the target.
static const double UNSURE = 4.0;
static const double PICTURES = 2.0; // of a measurement
// Paths of a frame below which another way to fill the grid does not repay its linking and its trial.
static const double CHOICE_LEAST = 3e5;

int scatter_paths_of(int path_rung)
{
    return (int)lround(exp2(0.5 * path_rung));
}

struct walk {
    const struct scatter_search *search;
    struct scatter_finding finding;
    double traced; // by all measurements
    double least;  // the least square that was met
    bool is_dear;  // no grid was found cheaply
    // What the last grid tells of its nodes, had these a cube: the share whose walks are made, times their length.
    double share;
    double length;       // of a walk, relative to the usual one
    double pixel_length; // of a path of a pixel, relative to a usual walk; 0: not known yet
    bool has_tried_pixels;
    // The finest grid whose cells alone were too much; 0 cells: none yet.
    int coarse_rung;
    double coarse_cells;
    bool is_coarse_sure;
    int first_coarse_rung; // the first such grid, from which on its power tells how cells become less
    double first_coarse_cells;
    // The noise of one path of each node, times the number of cells along a side, as pixels see nodes along a ray: the
    // largest of all grids that were tried, and their sum.
    double noise, noise_sum;
    int noise_count;
};

// Of a path of a pixel, relative to a usual walk: as that of walks until it is known.
static double pixel_length_of(const struct walk *walk)
{
    return walk->pixel_length > 0.0 ? walk->pixel_length : walk->length;
}

// The number of paths of one rung 0, in walks.
static double nodes_of(const struct walk *walk, const struct scatter_setting *setting)
{
    if (setting->grid_rung == SCATTER_PIXELS) return walk->search->pixels * pixel_length_of(walk);
    return pow(scatter_grid_cells[setting->grid_rung], 3.0) *
           (setting->is_from_lights ? SCATTER_PARTICLE * walk->length : walk->share);
}

static double trial_of(const struct walk *walk, const struct scatter_setting *setting)
{
    double nodes = setting->grid_rung == SCATTER_PIXELS ? walk->search->list_pixels * pixel_length_of(walk)
                                                        : nodes_of(walk, setting);

    return PICTURES * nodes * scatter_paths_of(setting->path_rung);
}

static bool measure(struct walk *walk, const struct scatter_setting *setting, struct scatter_measured *measured)
{
    double foretold = trial_of(walk, setting);
    bool is_counted;

    if (!walk->search->measure(walk->search->user, setting, measured)) {
        walk->finding.is_stopped = true;
        return false;
    }
    is_counted = measured->walks > 0.0 && measured->usual_walks > 0.0;
    walk->traced += is_counted ? PICTURES * measured->usual_walks : foretold;
    if (is_counted && setting->grid_rung == SCATTER_PIXELS) {
        walk->pixel_length = measured->usual_walks / measured->walks;
    } else if (is_counted) {
        walk->share = measured->usual_walks /
                      (pow(scatter_grid_cells[setting->grid_rung], 3.0) * scatter_paths_of(setting->path_rung));
        walk->length = measured->usual_walks / measured->walks;
    }
    return true;
}

static bool has_found_grid(const struct walk *walk)
{
    return walk->finding.is_found && walk->finding.setting.grid_rung != SCATTER_PIXELS;
}

// True while a measurement is affordable. Where a frame takes many paths by all that is known, a share of them is spent
// on finding something cheaper.
static bool is_affordable(const struct walk *walk, const struct scatter_setting *setting)
{
    static const double SHARE_OF_FRAME = 0.25;
    double most = walk->search->path_max, paths = trial_of(walk, setting);

    if (walk->is_dear && walk->finding.is_found) most = fmax(most, SHARE_OF_FRAME * walk->finding.paths);
    if (setting->path_rung >= SCATTER_PATH_RUNGS || walk->traced + paths > most) return false;
    return setting->grid_rung == SCATTER_PIXELS || paths <= GRID_PART * most;
}

static void keep(struct walk *walk, const struct scatter_setting *setting, double cells, double noise)
{
    double square = cells + noise;
    double paths = nodes_of(walk, setting) * scatter_paths_of(setting->path_rung), target = walk->search->target;
    bool is_within = square <= target * target;

    if (walk->finding.is_found ? !is_within || paths >= walk->finding.paths : !is_within && square >= walk->least)
        return;
    walk->finding = (struct scatter_finding){
        .setting = *setting, .error = sqrt(fmax(square, 0.0)), .cells = cells, .paths = paths, .is_found = is_within};
    walk->least = square;
}

// By how many rungs paths leave no more than `allowed` of the noise.
static int find_rungs(double noise, double allowed, int path_rung)
{
    int by = noise > 0.0 ? (int)ceil(2.0 * log2(noise / allowed)) : -path_rung;

    if (path_rung + by < 0) return -path_rung;
    return path_rung + by < SCATTER_PATH_RUNGS ? by : SCATTER_PATH_RUNGS - 1 - path_rung;
}

// What cells add. Where paths are few, chance alone looks like cells: what it has above the target is taken away.
static double sure_cells(const struct walk *walk, const struct scatter_measured *measured)
{
    double wanted = walk->search->target * walk->search->target;

    return fmax(measured->cells - fmax(measured->chance - wanted, 0.0), 0.0);
}

// That of a grid as coarser ones foretell it, with the power by which it mostly falls.
static double expect_cells(const struct walk *walk, int grid_rung, double power)
{
    double ratio = (double)scatter_grid_cells[walk->coarse_rung] / scatter_grid_cells[grid_rung];

    return ratio < 1.0 ? walk->coarse_cells * pow(ratio, power) : 0.0;
}

// What cells add, and its standard deviation; that is INFINITY where coarser grids foretell nothing.
struct estimate {
    double cells, spread;
};

// What is measured and what coarser grids foretell are weighed by the inverses of their variances. A sure measurement
// that is above the latter by more than its chance contradicts it: light that is not smooth, as in a skin that is
// thinner than a cell, is foretold as badly as that. Coarser grids had walks from their nodes, and foretell nothing of
// particles.
static struct estimate find_cells(const struct walk *walk, const struct scatter_setting *setting,
                                  const struct scatter_measured *measured)
{
    double wanted = walk->search->target * walk->search->target;
    double foretold = setting->is_from_lights ? 0.0 : expect_cells(walk, setting->grid_rung, USUAL);
    double above = measured->cells - foretold, spread = USUAL_SPREAD * foretold, trust;

    if (foretold == 0.0) return (struct estimate){sure_cells(walk, measured), INFINITY};
    if (measured->chance <= UNSURE * wanted) spread = fmax(spread, above - measured->chance);
    trust = spread * spread / (spread * spread + measured->chance * measured->chance);
    return (struct estimate){fmax(foretold + trust * above, 0.0), spread * sqrt(1.0 - trust)};
}

static void note_grid(struct walk *walk, const struct scatter_setting *setting, const struct scatter_measured *measured,
                      double cells)
{
    double wanted = walk->search->target * walk->search->target;
    double noise = measured->noise * scatter_paths_of(setting->path_rung) * scatter_grid_cells[setting->grid_rung];

    walk->noise = fmax(walk->noise, noise);
    walk->noise_sum += noise;
    walk->noise_count++;
    if (cells <= CELLS_SHARE * wanted) return;
    if (walk->first_coarse_cells == 0.0 || setting->grid_rung < walk->first_coarse_rung) {
        walk->first_coarse_rung = setting->grid_rung;
        walk->first_coarse_cells = cells;
    }
    walk->coarse_rung = setting->grid_rung;
    walk->coarse_cells = cells;
    walk->is_coarse_sure = measured->chance <= UNSURE * wanted;
}

// The power by which cells of coarse grids became less, at most STEEPEST.
static double find_power(const struct walk *walk)
{
    double finer = (double)scatter_grid_cells[walk->coarse_rung] / scatter_grid_cells[walk->first_coarse_rung];

    if (!(finer > 1.0)) return STEEPEST;
    return fmin(fmax(log(walk->first_coarse_cells / walk->coarse_cells) / log(finer), 0.0), STEEPEST);
}

// Where all grids that could be tried are too coarse, chooses one from `rung` on by what they tell: nothing that would
// outdo what was found where chance hides their cells.
static void guess_grid(struct walk *walk, int rung)
{
    double wanted = walk->search->target * walk->search->target;

    if (walk->finding.is_found && !walk->is_coarse_sure) return;
    for (; walk->coarse_cells > 0.0 && rung <= GRID_GUESSED; rung++) {
        double cells = expect_cells(walk, rung, find_power(walk)), noise = walk->noise / scatter_grid_cells[rung];
        int paths;

        if (cells > CELLS_SHARE * wanted) continue;
        paths = find_rungs(noise, wanted - cells, 0);
        keep(walk, &(struct scatter_setting){.grid_rung = rung, .path_rung = paths}, cells, noise * exp2(-0.5 * paths));
        return;
    }
}

// True where the cells alone are over their share, and so much that chance does not matter.
static bool is_too_coarse(const struct walk *walk, const struct scatter_setting *setting,
                          const struct scatter_measured *measured)
{
    double wanted = walk->search->target * walk->search->target;
    struct estimate found = find_cells(walk, setting, measured);

    return measured->cells > wanted + measured->noise || found.cells - found.spread > CELLS_SHARE * wanted;
}

// True where the paths that the noise alone asks for save nothing beside what was found: a grid with them is measured
// by two pictures, which its frames have to repay. Few paths do not know the noise well: a rung more is allowed.
static bool is_too_dear(const struct walk *walk, const struct scatter_setting *setting, double noise)
{
    static const double DEARER = 1.42;
    double wanted = walk->search->target * walk->search->target;
    double frames = walk->search->frames, most = DEARER * walk->finding.paths * frames / (frames + PICTURES);
    int paths = setting->path_rung + find_rungs(noise, wanted, setting->path_rung);

    return walk->finding.is_found && nodes_of(walk, setting) * scatter_paths_of(paths) > most;
}

static const struct scatter_setting first_pixels = {.grid_rung = SCATTER_PIXELS, .path_rung = PIXEL_PATHS_FIRST};

// Paths of pixels have noise alone, which follows from all paths that were traced. Few of them may miss what is bright
// and rare: a second measurement has four times as many, unless they are far dearer than a grid that was found.
static bool try_pixels(struct walk *walk)
{
    static const double LEAST = 0.5;
    struct scatter_setting setting = first_pixels;
    struct scatter_measured coarse, fine;
    double noise, wanted = walk->search->target * walk->search->target;
    int by;

    walk->has_tried_pixels = true;
    if (!measure(walk, &setting, &coarse)) return false;
    if (isinf(coarse.noise)) return true;
    noise = coarse.noise;
    by = find_rungs(LEAST * noise, wanted, setting.path_rung);
    if (has_found_grid(walk) &&
        nodes_of(walk, &setting) * scatter_paths_of(setting.path_rung + by) > walk->finding.paths)
        return true;
    setting.path_rung += FOURFOLD;
    if (is_affordable(walk, &setting)) {
        if (!measure(walk, &setting, &fine)) return false;
        if (isfinite(fine.noise)) noise = fmax((0.25 * coarse.noise + 4.0 * fine.noise) / 1.25, LEAST * coarse.noise);
    }
    setting.path_rung = PIXEL_PATHS_FIRST;
    by = find_rungs(noise, wanted, setting.path_rung);
    setting.path_rung += by;
    keep(walk, &setting, 0.0, noise * exp2(-0.5 * by));
    return true;
}

// Before a grid is measured that takes more than a look at paths of pixels, these are: they say what is too dear.
static bool know_pixels(struct walk *walk, const struct scatter_setting *setting)
{
    return walk->has_tried_pixels || trial_of(walk, setting) <= trial_of(walk, &first_pixels) || try_pixels(walk);
}

// Measures a grid with so many paths that the noise hides its cells no longer, or as many as may be traced, or until
// they do not matter. `setting` becomes the one that was measured last.
static bool measure_grid(struct walk *walk, struct scatter_setting *setting, struct scatter_measured *measured)
{
    double wanted = walk->search->target * walk->search->target;

    if (!measure(walk, setting, measured)) return false;
    while (isfinite(measured->noise) && measured->noise > wanted && !is_too_coarse(walk, setting, measured) &&
           !is_too_dear(walk, setting, measured->noise)) {
        struct scatter_setting next = *setting;
        struct scatter_measured finer;

        next.path_rung += find_rungs(measured->noise, fmax(wanted, 0.5 * measured->cells), setting->path_rung);
        if (!know_pixels(walk, &next)) return false;
        if (is_too_dear(walk, setting, measured->noise)) break;
        while (next.path_rung > setting->path_rung && !is_affordable(walk, &next))
            next.path_rung--;
        if (next.path_rung == setting->path_rung) break;
        if (!measure(walk, &next, &finer)) return false;
        if (isinf(finer.noise)) break;
        *setting = next;
        *measured = finer;
    }
    return true;
}

// The noise that all grids so far tell of one; 0: none was tried.
static double find_usual_noise(const struct walk *walk, const struct scatter_setting *setting)
{
    double count = (double)scatter_paths_of(setting->path_rung) * scatter_grid_cells[setting->grid_rung];

    return walk->noise_count > 0 ? walk->noise_sum / walk->noise_count / count : 0.0;
}

// Few nodes may have little noise by luck: what all grids tell counts as much as the one that is measured.
static double find_noise(const struct walk *walk, const struct scatter_setting *setting,
                         const struct scatter_measured *measured)
{
    if (setting->is_from_lights || walk->noise_count == 0) return measured->noise;
    return fmax(measured->noise, 0.5 * (measured->noise + find_usual_noise(walk, setting)));
}

// False where the cells' part is lost in chance. Such a grid is chosen only where paths of pixels, which have no cells,
// cannot be had: a picture that misses costs more than one that is dear.
static bool has_sure_cells(const struct walk *walk, const struct scatter_setting *setting,
                           const struct scatter_measured *measured)
{
    double wanted = walk->search->target * walk->search->target;
    struct estimate found = find_cells(walk, setting, measured);

    return measured->chance <= UNSURE * wanted || (walk->is_coarse_sure && found.spread <= UNSURE * wanted);
}

// Tries one grid, which is kept where it is the cheapest.
static bool try_grid(struct walk *walk, struct scatter_setting setting, struct scatter_measured *measured)
{
    double wanted = walk->search->target * walk->search->target, cells, noise;

    if (!measure_grid(walk, &setting, measured)) return false;
    if (isinf(measured->noise)) return true;
    cells = find_cells(walk, &setting, measured).cells;
    if (!setting.is_from_lights) note_grid(walk, &setting, measured, cells);
    // Its cells are not known where it was left early.
    if (measured->noise > wanted && measured->chance > wanted && is_too_dear(walk, &setting, measured->noise))
        return true;
    if (cells <= CELLS_SHARE * wanted && !has_sure_cells(walk, &setting, measured)) {
        if (!walk->has_tried_pixels && !try_pixels(walk)) return false;
        if (walk->finding.is_found) return true;
    }
    noise = find_noise(walk, &setting, measured);
    if (cells <= CELLS_SHARE * wanted) {
        int by = find_rungs(noise, wanted - cells, setting.path_rung);

        setting.path_rung += by;
        keep(walk, &setting, cells, noise * exp2(-0.5 * by));
    } else {
        keep(walk, &setting, cells, noise);
    }
    return true;
}

static struct scatter_setting first_of(int grid_rung)
{
    return (struct scatter_setting){.grid_rung = grid_rung, .path_rung = PATHS_FIRST};
}

// By how many rungs cells have to be finer. Their squared error falls with the fourth power of their size where light
// is smooth, and not as quickly elsewhere: one rung less than that.
static int find_finer(const struct walk *walk, int grid_rung)
{
    double allowed = CELLS_SHARE * walk->search->target * walk->search->target;
    double cells = grid_rung == walk->coarse_rung ? walk->coarse_cells : 0.0;
    int by = cells > allowed ? (int)(log2(cells / allowed) / 2.0) : 1;

    for (; by > 1; by--) {
        struct scatter_setting next = first_of(grid_rung + by);

        if (grid_rung + by < SCATTER_GRID_RUNGS && is_affordable(walk, &next)) break;
    }
    return by > 1 ? by : 1;
}

// Finer grids from *rung on, until one keeps the target and the next costs more. Where something dear is known, none is
// tried that its noise makes dearer: nodes grow with the third power of the cells, and their noise falls with the
// first. *rung becomes the first that was not tried.
static bool try_finer(struct walk *walk, int *rung)
{
    for (;;) {
        struct scatter_setting setting = first_of(*rung);
        struct scatter_measured measured;

        if (*rung >= SCATTER_GRID_RUNGS || !is_affordable(walk, &setting)) return true;
        if (!know_pixels(walk, &setting)) return false;
        if (walk->has_tried_pixels && is_too_dear(walk, &setting, find_usual_noise(walk, &setting))) return true;
        if (!try_grid(walk, setting, &measured)) return false;
        *rung += find_finer(walk, setting.grid_rung);
        if (has_found_grid(walk) && walk->finding.setting.grid_rung < setting.grid_rung) return true;
    }
}

// Down to the finest grid that is known to be too coarse.
static bool try_coarser(struct walk *walk)
{
    int before = walk->finding.setting.grid_rung, last = walk->coarse_cells > 0.0 ? walk->coarse_rung + 1 : 0;
    struct scatter_measured measured;

    for (int rung = before - 1; rung >= last && walk->finding.is_found && before == rung + 1; rung--) {
        if (!try_grid(walk, first_of(rung), &measured)) return false;
        before = walk->finding.setting.grid_rung;
    }
    return true;
}

static bool try_ways(struct walk *walk)
{
    int rung = GRID_FIRST;

    if (walk->search->has_grid && !try_finer(walk, &rung)) return false;
    if (!walk->has_tried_pixels && !try_pixels(walk)) return false;
    if (!walk->search->has_grid) return true;
    if (has_found_grid(walk)) return try_coarser(walk);
    guess_grid(walk, rung);
    walk->is_dear = true;
    return try_finer(walk, &rung);
}

// Fills the grid that was found from the lights, with so few paths that both pictures cost an eighth of it. Where none
// suffices, they may take what a measurement may.
static bool try_lights(struct walk *walk)
{
    struct scatter_setting setting = walk->finding.setting;
    struct scatter_measured measured;
    double most = 0.125 * walk->finding.paths;

    if (!walk->search->may_choose || setting.grid_rung < 0 || walk->finding.paths < CHOICE_LEAST) return true;
    if (!walk->finding.is_found) most = fmin(most, GRID_PART * walk->search->path_max);
    setting.is_from_lights = true;
    setting.path_rung = (int)floor(2.0 * log2(most / (PICTURES * nodes_of(walk, &setting))));
    if (setting.path_rung < 0) return true;
    walk->is_dear = true;
    return try_grid(walk, setting, &measured);
}

void scatter_finding_refine(struct scatter_finding *finding, double paths_most)
{
    struct scatter_setting *setting = &finding->setting;
    bool has_grid = setting->grid_rung != SCATTER_PIXELS;
    double noise = finding->error * finding->error - finding->cells;

    // A rung of cells and two of paths lower both parts of the error alike.
    while (finding->is_found && setting->path_rung + 2 < SCATTER_PATH_RUNGS) {
        double finer = 1.0, times;

        if (has_grid && setting->grid_rung >= GRID_GUESSED) break;
        if (has_grid)
            finer = (double)scatter_grid_cells[setting->grid_rung + 1] / scatter_grid_cells[setting->grid_rung];
        times = 2.0 * pow(finer, 3.0);
        if (finding->paths * times > paths_most) break;
        finding->paths *= times;
        setting->path_rung += 2;
        setting->grid_rung += has_grid;
        noise /= 2.0 * finer;
        finding->cells /= pow(finer, USUAL);
    }
    finding->error = sqrt(fmax(finding->cells + noise, 0.0));
}

struct scatter_finding scatter_search_run(const struct scatter_search *search)
{
    struct walk walk = {.search = search,
                        .finding = {.setting = {.grid_rung = SCATTER_PIXELS, .path_rung = PIXEL_PATHS_FIRST},
                                    .error = INFINITY,
                                    .paths = INFINITY},
                        .least = INFINITY,
                        .share = 1.0,
                        .length = 1.0};

    if (try_ways(&walk)) (void)try_lights(&walk);
    return walk.finding;
}
