// The cheapest paths that keep an error, on known errors.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_search.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static const double PIXELS = 160.0 * 120.0;

// The error of cells falls with their number's square. A pixel sees several nodes, each with the noise of its paths.
struct terrain {
    double cells, noise, pixel_noise;
    double chance;  // of the cells' square: added to one measurement, taken from the next
    unsigned luck;  // 0: none; else the noise of each measurement is off by some half
    int stop_after; // measurements; 0: never
    int measured;
    double traced;
    int finest;      // that was measured
    int few;         // cells; 0: 16
    int most_of_few; // the largest rung of paths of at most so many cells
    bool is_chance_known;
    double lights_noise; // of particles from the lights, relative to walks; 0: there is no choice
    int lights_measured;
    double seen, length; // the share of nodes whose walks are made, and their length over the usual one; 0: not counted
    double pixel_length; // of paths of pixels; 0: not counted
    double frames;       // 0: a million
};

// A factor of 0.5 to 1.7 or so, 1 in the mean: the mean of four exponential numbers.
static double draw_luck(struct terrain *terrain)
{
    double sum = 0.0;

    for (int i = 0; i < 4; i++) {
        terrain->luck = terrain->luck * 1664525u + 1013904223u;
        sum -= log((terrain->luck >> 8) / 16777216.0 + 1e-9);
    }
    return sum / 4.0;
}

static double square_of(const struct terrain *terrain, int grid_rung, int path_rung)
{
    double cells;

    if (grid_rung == SCATTER_PIXELS) return terrain->pixel_noise * exp2(-0.5 * path_rung);
    cells = terrain->cells / pow(scatter_grid_cells[grid_rung], 2.0);
    return cells * cells + terrain->noise * exp2(-0.5 * path_rung) / scatter_grid_cells[grid_rung];
}

static bool measure(void *user, const struct scatter_setting *setting, struct scatter_measured *measured)
{
    struct terrain *terrain = user;
    int grid_rung = setting->grid_rung, path_rung = setting->path_rung;
    double cells = square_of(terrain, grid_rung, 120), noise = square_of(terrain, grid_rung, path_rung) - cells;

    if (setting->is_from_lights) {
        noise *= terrain->lights_noise;
        terrain->lights_measured++;
    }
    if (grid_rung >= 0 && scatter_grid_cells[grid_rung] <= (terrain->few ? terrain->few : 16) &&
        path_rung > terrain->most_of_few)
        terrain->most_of_few = path_rung;
    if (grid_rung > terrain->finest) terrain->finest = grid_rung;
    terrain->traced +=
        2.0 * (grid_rung == SCATTER_PIXELS ? 64.0 : pow(scatter_grid_cells[grid_rung], 3.0)) * exp2(0.5 * path_rung);
    if (terrain->luck > 0) noise *= draw_luck(terrain);
    *measured = (struct scatter_measured){.cells = cells + (terrain->measured % 2 ? -1 : 1) * terrain->chance,
                                          .chance = terrain->is_chance_known ? fabs(terrain->chance) : 0.0,
                                          .noise = noise};
    if (terrain->seen > 0.0 && grid_rung >= 0 && !setting->is_from_lights) {
        measured->walks = terrain->seen * pow(scatter_grid_cells[grid_rung], 3.0) * exp2(0.5 * path_rung);
        measured->usual_walks = terrain->length * measured->walks;
    }
    if (terrain->pixel_length > 0.0 && grid_rung == SCATTER_PIXELS) {
        measured->walks = 64.0 * exp2(0.5 * path_rung);
        measured->usual_walks = terrain->pixel_length * measured->walks;
    }
    return ++terrain->measured != terrain->stop_after;
}

static struct scatter_finding search_within(struct terrain *terrain, double target, bool has_grid, double path_max)
{
    return scatter_search_run(&(struct scatter_search){.target = target,
                                                       .pixels = PIXELS,
                                                       .frames = terrain->frames > 0.0 ? terrain->frames : 1e6,
                                                       .has_grid = has_grid,
                                                       .may_choose = terrain->lights_noise > 0.0,
                                                       .path_max = path_max,
                                                       .list_pixels = 64,
                                                       .measure = measure,
                                                       .user = terrain});
}

static struct scatter_finding search(struct terrain *terrain, double target, bool has_grid)
{
    return search_within(terrain, target, has_grid, 1e9);
}

static double cost_of(int grid_rung, int path_rung)
{
    return (grid_rung == SCATTER_PIXELS ? PIXELS : pow(scatter_grid_cells[grid_rung], 3.0)) * exp2(0.5 * path_rung);
}

static double find_least_cost(const struct terrain *terrain, double target)
{
    double least = INFINITY;

    for (int grid = SCATTER_PIXELS; grid < SCATTER_GRID_RUNGS; grid++)
        for (int path = 0; path < SCATTER_PATH_RUNGS; path++)
            if (square_of(terrain, grid, path) <= target * target) least = fmin(least, cost_of(grid, path));
    return least;
}

static void what_is_found_keeps_the_target_and_is_cheap(void **state)
{
    static const double targets[] = {0.003, 0.01, 0.03, 0.1}, cells[] = {0.05, 1.0, 4.0, 20.0};

    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++)
        for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
            struct terrain terrain = {.cells = cells[k], .noise = 5.0, .pixel_noise = 1.3};
            struct scatter_finding found = search(&terrain, targets[i], true);

            assert_true(found.is_found);
            assert_true(square_of(&terrain, found.setting.grid_rung, found.setting.path_rung) <=
                        1.001 * targets[i] * targets[i]);
            assert_true(cost_of(found.setting.grid_rung, found.setting.path_rung) <=
                        4.0 * find_least_cost(&terrain, targets[i]));
        }
}

// Grids that the noise alone makes dearer than what was found are not tried. What is found knows how much of its error
// is cells.
static void what_cannot_be_cheaper_is_left_early(void **state)
{
    struct terrain terrain = {.cells = 4.0, .noise = 5.0, .pixel_noise = 1e3};
    struct scatter_finding found = search(&terrain, 0.01, true);
    double cells = square_of(&terrain, found.setting.grid_rung, 120);

    (void)state;
    assert_true(found.is_found);
    assert_float_equal(found.cells, cells, 0.1 * cells);
    assert_int_equal(terrain.finest, found.setting.grid_rung);
}

// Every grid costs more than paths of pixels by its noise, and those that may be tried first have too large cells.
static void grids_that_are_dear_by_noise_have_no_finer_ones(void **state)
{
    struct terrain terrain = {.cells = 20.0, .noise = 40.0, .pixel_noise = 1.0, .seen = 1.0, .length = 8.0};
    struct scatter_finding found = search_within(&terrain, 0.02, true, 5e5);

    (void)state;
    assert_true(found.is_found);
    assert_int_equal(found.setting.grid_rung, SCATTER_PIXELS);
    assert_int_equal(scatter_grid_cells[terrain.finest], 16); // the last before paths of pixels are tried
}

// What chance may add to cells makes no grid finer than it must be.
static void chance_is_not_taken_for_cells(void **state)
{
    struct terrain terrain = {.cells = 1.0, .noise = 5.0, .pixel_noise = 1e3, .chance = 4e-3};
    struct scatter_finding fine = search(&terrain, 0.03, true), found;

    terrain = (struct terrain){.cells = 1.0, .noise = 5.0, .pixel_noise = 1e3, .chance = 4e-3, .is_chance_known = true};
    found = search(&terrain, 0.03, true);
    assert_true(found.is_found && found.paths < fine.paths);
    assert_true(square_of(&terrain, found.setting.grid_rung, found.setting.path_rung) <= 0.03 * 0.03);
    (void)state;
}

// The light that pictures are compared with is known by random paths, too: that hides neither noise nor cells.
static void chance_hides_no_noise(void **state)
{
    static const double chances[] = {-6e-4, -3e-4, 3e-4, 6e-4}; // two thirds of the target's square

    for (double noise = 1.0; noise < 40.0; noise *= 1.3)
        for (size_t i = 0; i < sizeof chances / sizeof *chances; i++) {
            struct terrain terrain = {.noise = noise, .pixel_noise = 1e3, .chance = chances[i]};
            struct scatter_finding found = search(&terrain, 0.03, true);

            assert_true(square_of(&terrain, found.setting.grid_rung, found.setting.path_rung) <= 0.03 * 0.03);
        }
    (void)state;
}

// A particle costs as much as two and a half walks.
static void the_lights_fill_a_grid_where_that_costs_less(void **state)
{
    static const struct {
        double noise; // relative to that of walks
        bool is_chosen;
    } rows[] = {{1.0, false}, {0.5, false}, {0.15, true}, {0.02, true}};

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct terrain terrain = {.cells = 1.0, .noise = 40.0, .pixel_noise = 1e4, .lights_noise = rows[i].noise};
        struct scatter_finding found = search(&terrain, 0.01, true);
        double cells = square_of(&terrain, found.setting.grid_rung, 120);
        double noise = square_of(&terrain, found.setting.grid_rung, found.setting.path_rung) - cells;

        assert_int_equal(found.setting.is_from_lights, rows[i].is_chosen);
        assert_true(terrain.lights_measured > 0 && terrain.lights_measured <= 2);
        assert_true(cells + noise * (rows[i].is_chosen ? rows[i].noise : 1.0) <= 1.001e-4);
    }
    (void)state;
}

// Another way has programs to link, and a trial of its own.
static void a_cheap_grid_is_filled_as_it_comes(void **state)
{
    struct terrain terrain = {.cells = 0.5, .noise = 0.1, .pixel_noise = 1e4, .lights_noise = 0.01};

    assert_false(search(&terrain, 0.03, true).setting.is_from_lights);
    assert_int_equal(terrain.lights_measured, 0);
    (void)state;
}

// Nodes that the camera hardly sees have few walks: the search may look at grids that are finer for it.
static void hidden_nodes_are_not_paid_for(void **state)
{
    struct terrain open = {.cells = 12.0, .noise = 25.0, .pixel_noise = 600.0}, hidden = open;
    struct scatter_finding dear = search_within(&open, 0.01, true, 6e6), found;

    hidden.seen = 0.05;
    hidden.length = 1.0;
    found = search_within(&hidden, 0.01, true, 6e6);
    assert_true(found.is_found && found.paths < 0.2 * dear.paths);
    assert_true(fabs(found.paths - 0.05 * cost_of(found.setting.grid_rung, found.setting.path_rung)) <
                1e-2 * found.paths);
    (void)state;
}

// Paths that are scattered a thousand times take a thousand looks, from pixels as from nodes.
static void long_walks_cost_what_they_take(void **state)
{
    struct terrain usual = {.cells = 4.0, .noise = 25.0, .pixel_noise = 60.0, .seen = 1.0, .length = 1.0};
    struct terrain longer = usual;
    struct scatter_finding found = search_within(&usual, 0.01, true, 6e7), dear;

    longer.length = 30.0;
    dear = search_within(&longer, 0.01, true, 6e7);
    assert_true(dear.paths > 10.0 * found.paths);
    assert_true(longer.length * longer.traced < 0.3 * dear.paths);
    (void)state;
}

// Paths of pixels may be much shorter than walks that begin deep inside, and cost what they take.
static void short_paths_of_pixels_are_chosen(void **state)
{
    struct terrain alike = {.cells = 4.0, .noise = 25.0, .pixel_noise = 60.0, .seen = 1.0, .length = 8.0};
    struct terrain shorter = alike;
    struct scatter_finding found = search(&alike, 0.01, true);

    alike.pixel_length = 8.0;
    shorter.pixel_length = 0.1;
    assert_true(found.setting.grid_rung >= 0);
    assert_true(search(&alike, 0.01, true).setting.grid_rung >= 0);
    found = search(&shorter, 0.01, true);
    assert_int_equal(found.setting.grid_rung, SCATTER_PIXELS);
    assert_true(fabs(found.paths - 0.1 * cost_of(SCATTER_PIXELS, found.setting.path_rung)) < 1e-2 * found.paths);
    (void)state;
}

// The first grid is not measured well where its noise alone makes it dearer than paths of pixels.
static void a_noisy_grid_is_left_for_pixels(void **state)
{
    struct terrain terrain = {.cells = 0.1, .noise = 4000.0, .pixel_noise = 1.0};

    assert_int_equal(search(&terrain, 0.02, true).setting.grid_rung, SCATTER_PIXELS);
    assert_int_equal(terrain.most_of_few, 8); // with which each grid begins
    (void)state;
}

// A grid whose cells are lost in chance is not taken for a good one where pixels can have paths, however dear.
static void what_chance_hides_is_not_trusted(void **state)
{
    struct terrain hidden = {
        .cells = 0.1, .noise = 5.0, .pixel_noise = 100.0, .chance = 2.5e-3, .is_chance_known = true};
    struct terrain known = hidden;

    known.chance = 1e-4;
    assert_int_equal(search(&hidden, 0.02, true).setting.grid_rung, SCATTER_PIXELS);
    assert_true(search(&known, 0.02, true).setting.grid_rung >= 0);
    hidden.pixel_noise = 1e9;
    assert_true(search(&hidden, 0.02, true).setting.grid_rung >= 0);
    (void)state;
}

// Grids whose cells are over their share by chance alone foretell no finer one that would outdo paths of pixels.
static void what_chance_hides_foretells_nothing(void **state)
{
    struct terrain hidden = {
        .cells = 20.0, .noise = 0.5, .pixel_noise = 300.0, .chance = 2.5e-3, .is_chance_known = true};
    struct terrain known = hidden;

    known.chance = 1e-4;
    assert_int_equal(search_within(&hidden, 0.02, true, 5e5).setting.grid_rung, SCATTER_PIXELS);
    assert_true(search_within(&known, 0.02, true, 5e5).setting.grid_rung >= 0);
    (void)state;
}

// A trial that takes as long as it saves is left out where only one frame has it.
static void trials_are_repaid_by_frames(void **state)
{
    struct terrain many = {.cells = 12.0, .noise = 25.0, .pixel_noise = 100.0}, one = many;
    struct scatter_finding dear, cheap = search(&many, 0.01, true);

    one.frames = 1.0;
    dear = search(&one, 0.01, true);
    assert_true(cheap.is_found && dear.is_found);
    assert_true(dear.paths < 3.0 * cheap.paths);
    assert_true(one.traced + dear.paths < many.traced + cheap.paths);
    (void)state;
}

// What chance hides in a fine grid follows from coarser ones that were measured well.
static void coarser_grids_tell_what_chance_hides(void **state)
{
    static const double chances[] = {-1e-4, 1e-4};

    for (size_t i = 0; i < 2; i++) {
        struct terrain terrain = {
            .cells = 5.0, .noise = 0.2, .pixel_noise = 1e4, .chance = chances[i], .is_chance_known = true};
        struct scatter_finding found = search(&terrain, 0.01, true);

        assert_true(found.is_found);
        assert_true(square_of(&terrain, found.setting.grid_rung, found.setting.path_rung) <= 1.2 * 0.01 * 0.01);
        assert_true(scatter_grid_cells[found.setting.grid_rung] <= 45);
    }
    (void)state;
}

// What they foretell, with what few paths tell, is enough to leave a grid that is too coarse.
static void coarser_grids_spare_paths(void **state)
{
    struct terrain terrain = {
        .cells = 20.0, .noise = 7.0, .pixel_noise = 600.0, .chance = 2e-4, .is_chance_known = true, .few = 32};
    struct scatter_finding found = search(&terrain, 0.014, true);

    assert_true(found.is_found && scatter_grid_cells[found.setting.grid_rung] >= 45);
    assert_true(scatter_paths_of(terrain.most_of_few) <= 512);
    assert_true(square_of(&terrain, found.setting.grid_rung, found.setting.path_rung) <= 1.2 * 0.014 * 0.014);
    (void)state;
}

static void light_that_no_grid_holds_gets_paths_of_pixels(void **state)
{
    struct terrain rough = {.cells = 1e4, .noise = 5.0, .pixel_noise = 1.3}, smooth = rough;
    struct scatter_finding found = search(&rough, 0.01, true);

    smooth.cells = 1.0;
    assert_true(found.is_found && found.setting.grid_rung == SCATTER_PIXELS);
    assert_int_equal(found.setting.path_rung, (int)ceil(2.0 * log2(1.3 / 1e-4)));
    assert_true(search(&smooth, 0.01, true).setting.grid_rung >= 0);
    assert_int_equal(search(&smooth, 0.01, false).setting.grid_rung, SCATTER_PIXELS);
}

// A thick cloud: a grid that keeps the target takes more paths than the search may trace, pixels a thousand times more.
static void a_grid_too_fine_to_be_tried_is_found_by_coarser_ones(void **state)
{
    static const double targets[] = {0.01, 0.013, 0.02};

    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
        struct terrain thick = {.cells = 12.0, .noise = 25.0, .pixel_noise = 600.0};
        struct scatter_finding found = search_within(&thick, targets[i], true, 6e6);

        assert_true(found.is_found && found.setting.grid_rung >= 0);
        assert_true(square_of(&thick, found.setting.grid_rung, found.setting.path_rung) <=
                    1.2 * targets[i] * targets[i]);
        assert_true(cost_of(found.setting.grid_rung, found.setting.path_rung) <=
                    4.0 * find_least_cost(&thick, targets[i]));
    }
    (void)state;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

// A frame's own noise is off its mean by a half or so: that is not taken for the error of cells.
static void noise_that_is_large_by_chance_makes_no_cell_finer(void **state)
{
    enum { TRIALS = 101 };
    double costs[TRIALS], least;

    for (unsigned i = 0; i < TRIALS; i++) {
        struct terrain terrain = {.cells = 0.5, .noise = 1.4, .pixel_noise = 1.3, .luck = i + 1};
        struct scatter_finding found = search_within(&terrain, 0.0065, true, 6e6);

        costs[i] = cost_of(found.setting.grid_rung, found.setting.path_rung);
    }
    qsort(costs, TRIALS, sizeof *costs, by_size);
    least = find_least_cost(&(struct terrain){.cells = 0.5, .noise = 1.4, .pixel_noise = 1.3}, 0.0065);
    assert_true(costs[TRIALS / 2] <= 1.2 * least);
    (void)state;
}

// Where cells are too large, more paths of their nodes would tell nothing: what may be traced is left for finer ones.
static void paths_are_not_spent_on_cells_that_are_too_large(void **state)
{
    struct terrain terrain = {.cells = 100.0, .noise = 160.0, .pixel_noise = 1e3};
    struct scatter_finding found = search_within(&terrain, 0.03, true, 6e7);

    assert_true(found.is_found && scatter_grid_cells[found.setting.grid_rung] >= 64);
    assert_true(terrain.most_of_few <= 16);
    assert_true(square_of(&terrain, found.setting.grid_rung, found.setting.path_rung) <= 1.001 * 0.03 * 0.03);
    (void)state;
}

// A frame whose pixels need many paths is worth a longer search for a grid.
static void a_search_costs_what_a_frame_allows(void **state)
{
    struct terrain dear = {.cells = 600.0, .noise = 0.1, .pixel_noise = 400.0}, cheap = dear;

    cheap.pixel_noise = 0.01;
    assert_true(search_within(&dear, 0.03, true, 1e6).setting.grid_rung >= 0);
    assert_true(dear.traced < 0.3 * cost_of(SCATTER_PIXELS, (int)ceil(2.0 * log2(400.0 / 0.03 / 0.03))));
    assert_int_equal(search_within(&cheap, 0.03, true, 1e6).setting.grid_rung, SCATTER_PIXELS);
    assert_true(cheap.traced <= 1e6);
    (void)state;
}

static void no_grid_beyond_128_cells_is_chosen_untried(void **state)
{
    for (double cells = 20.0; cells < 400.0; cells *= 1.5) {
        struct terrain thick = {.cells = cells, .noise = 0.01, .pixel_noise = 1e4};
        struct scatter_finding found = search_within(&thick, 0.01, true, 6e6);

        assert_true(!found.is_found ||
                    square_of(&thick, found.setting.grid_rung, found.setting.path_rung) <= 1.2 * 0.01 * 0.01);
        assert_true(found.setting.grid_rung < 0 || scatter_grid_cells[found.setting.grid_rung] <= 128 ||
                    found.setting.grid_rung <= thick.finest);
    }
    (void)state;
}

static void the_nearest_is_kept_where_nothing_suffices(void **state)
{
    struct terrain noisy = {.cells = 1e4, .noise = 1e6, .pixel_noise = 1e6};
    struct scatter_finding found = search(&noisy, 0.001, true);

    assert_false(found.is_found);
    assert_true(isfinite(found.error) && found.error > 0.001);
    noisy = (struct terrain){.cells = 0.1, .noise = 1e12, .pixel_noise = 1e15, .lights_noise = 0.9};
    assert_false(search_within(&noisy, 0.001, true, 1e6).is_found);
    assert_int_equal(noisy.lights_measured, 1);
    assert_true(noisy.traced < 2e6); // two pictures a measurement
}

static void a_search_ends_where_it_is_stopped(void **state)
{
    struct terrain terrain = {.cells = 1.0, .noise = 5.0, .pixel_noise = 1.3, .stop_after = 3};

    assert_true(search(&terrain, 0.01, true).is_stopped);
    assert_int_equal(terrain.measured, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_found_keeps_the_target_and_is_cheap),
        cmocka_unit_test(what_cannot_be_cheaper_is_left_early),
        cmocka_unit_test(grids_that_are_dear_by_noise_have_no_finer_ones),
        cmocka_unit_test(chance_is_not_taken_for_cells),
        cmocka_unit_test(chance_hides_no_noise),
        cmocka_unit_test(the_lights_fill_a_grid_where_that_costs_less),
        cmocka_unit_test(a_cheap_grid_is_filled_as_it_comes),
        cmocka_unit_test(hidden_nodes_are_not_paid_for),
        cmocka_unit_test(long_walks_cost_what_they_take),
        cmocka_unit_test(short_paths_of_pixels_are_chosen),
        cmocka_unit_test(a_noisy_grid_is_left_for_pixels),
        cmocka_unit_test(what_chance_hides_is_not_trusted),
        cmocka_unit_test(what_chance_hides_foretells_nothing),
        cmocka_unit_test(trials_are_repaid_by_frames),
        cmocka_unit_test(coarser_grids_tell_what_chance_hides),
        cmocka_unit_test(coarser_grids_spare_paths),
        cmocka_unit_test(light_that_no_grid_holds_gets_paths_of_pixels),
        cmocka_unit_test(a_grid_too_fine_to_be_tried_is_found_by_coarser_ones),
        cmocka_unit_test(noise_that_is_large_by_chance_makes_no_cell_finer),
        cmocka_unit_test(paths_are_not_spent_on_cells_that_are_too_large),
        cmocka_unit_test(a_search_costs_what_a_frame_allows),
        cmocka_unit_test(no_grid_beyond_128_cells_is_chosen_untried),
        cmocka_unit_test(the_nearest_is_kept_where_nothing_suffices),
        cmocka_unit_test(a_search_ends_where_it_is_stopped),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
