// The cheapest paths that keep an error, where chance hides it.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/scatter_terrain.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

// What chance may add to cells makes no grid finer than it must be.
static void chance_is_not_taken_for_cells(void **state)
{
    struct scatter_terrain terrain = {.cells = 1.0, .noise = 5.0, .pixel_noise = 1e3, .chance = 4e-3};
    struct scatter_finding fine = scatter_terrain_search(&terrain, 0.03, true), found;

    terrain = (struct scatter_terrain){
        .cells = 1.0, .noise = 5.0, .pixel_noise = 1e3, .chance = 4e-3, .is_chance_known = true};
    found = scatter_terrain_search(&terrain, 0.03, true);
    assert_true(found.is_found && found.paths < fine.paths);
    assert_true(scatter_terrain_found_square(&terrain, &found) <= 0.03 * 0.03);
    (void)state;
}

// The light that pictures are compared with is known by random paths, too: that hides neither noise nor cells.
static void chance_hides_no_noise(void **state)
{
    static const double chances[] = {-6e-4, -3e-4, 3e-4, 6e-4}; // two thirds of the target's square

    for (double noise = 1.0; noise < 40.0; noise *= 1.3)
        for (size_t i = 0; i < sizeof chances / sizeof *chances; i++) {
            struct scatter_terrain terrain = {.noise = noise, .pixel_noise = 1e3, .chance = chances[i]};
            struct scatter_finding found = scatter_terrain_search(&terrain, 0.03, true);

            assert_true(scatter_terrain_found_square(&terrain, &found) <= 0.03 * 0.03);
        }
    (void)state;
}

// A grid whose cells are lost in chance is not taken for a good one where pixels can have paths, however dear.
static void what_chance_hides_is_not_trusted(void **state)
{
    struct scatter_terrain hidden = {
        .cells = 0.1, .noise = 5.0, .pixel_noise = 100.0, .chance = 2.5e-3, .is_chance_known = true};
    struct scatter_terrain known = hidden;

    known.chance = 1e-4;
    assert_int_equal(scatter_terrain_search(&hidden, 0.02, true).setting.grid_rung, SCATTER_PIXELS);
    assert_true(scatter_terrain_search(&known, 0.02, true).setting.grid_rung >= 0);
    hidden.pixel_noise = 1e9;
    assert_true(scatter_terrain_search(&hidden, 0.02, true).setting.grid_rung >= 0);
    (void)state;
}

// Grids whose cells are over their share by chance alone foretell no finer one that would outdo paths of pixels.
static void what_chance_hides_foretells_nothing(void **state)
{
    struct scatter_terrain hidden = {
        .cells = 20.0, .noise = 0.5, .pixel_noise = 300.0, .chance = 2.5e-3, .is_chance_known = true};
    struct scatter_terrain known = hidden;

    known.chance = 1e-4;
    assert_int_equal(scatter_terrain_search_within(&hidden, 0.02, true, 5e5).setting.grid_rung, SCATTER_PIXELS);
    assert_true(scatter_terrain_search_within(&known, 0.02, true, 5e5).setting.grid_rung >= 0);
    (void)state;
}

// What chance hides in a fine grid follows from coarser ones that were measured well.
static void coarser_grids_tell_what_chance_hides(void **state)
{
    static const double chances[] = {-1e-4, 1e-4};

    for (size_t i = 0; i < 2; i++) {
        struct scatter_terrain terrain = {
            .cells = 5.0, .noise = 0.2, .pixel_noise = 1e4, .chance = chances[i], .is_chance_known = true};
        struct scatter_finding found = scatter_terrain_search(&terrain, 0.01, true);

        assert_true(found.is_found);
        assert_true(scatter_terrain_found_square(&terrain, &found) <= 1.2 * 0.01 * 0.01);
        assert_true(scatter_grid_cells[found.setting.grid_rung] <= 45);
    }
    (void)state;
}

// What they foretell, with what few paths tell, is enough to leave a grid that is too coarse.
static void coarser_grids_spare_paths(void **state)
{
    struct scatter_terrain terrain = {
        .cells = 20.0, .noise = 7.0, .pixel_noise = 600.0, .chance = 2e-4, .is_chance_known = true, .few = 32};
    struct scatter_finding found = scatter_terrain_search(&terrain, 0.014, true);

    assert_true(found.is_found && scatter_grid_cells[found.setting.grid_rung] >= 45);
    assert_true(scatter_paths_of(terrain.most_of_few) <= 512);
    assert_true(scatter_terrain_found_square(&terrain, &found) <= 1.2 * 0.014 * 0.014);
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
        struct scatter_terrain terrain = {.cells = 0.5, .noise = 1.4, .pixel_noise = 1.3, .luck = i + 1};
        struct scatter_finding found = scatter_terrain_search_within(&terrain, 0.0065, true, 6e6);

        costs[i] = scatter_terrain_cost(found.setting.grid_rung, found.setting.path_rung);
    }
    qsort(costs, TRIALS, sizeof *costs, by_size);
    least =
        scatter_terrain_least_cost(&(struct scatter_terrain){.cells = 0.5, .noise = 1.4, .pixel_noise = 1.3}, 0.0065);
    assert_true(costs[TRIALS / 2] <= 1.2 * least);
    (void)state;
}

// Light with a skin that no cells resolve, as a deep ball's: what contradicts coarser grids is believed.
static void what_contradicts_coarser_grids_is_believed(void **state)
{
    static const double skins[] = {2.5e-3, 4e-3}, chances[] = {-1e-3, 1e-3};

    for (size_t i = 0; i < 4; i++) {
        struct scatter_terrain deep = {.cells = 8.0,
                                       .skin = skins[i / 2],
                                       .noise = 20.0,
                                       .pixel_noise = 300.0,
                                       .chance = chances[i % 2],
                                       .is_chance_known = true};
        struct scatter_finding found = scatter_terrain_search_within(&deep, 0.021, true, 8e6);

        assert_true(found.is_found);
        assert_int_equal(found.setting.grid_rung, SCATTER_PIXELS);
    }
    (void)state;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chance_is_not_taken_for_cells),
        cmocka_unit_test(chance_hides_no_noise),
        cmocka_unit_test(what_chance_hides_is_not_trusted),
        cmocka_unit_test(what_chance_hides_foretells_nothing),
        cmocka_unit_test(coarser_grids_tell_what_chance_hides),
        cmocka_unit_test(coarser_grids_spare_paths),
        cmocka_unit_test(noise_that_is_large_by_chance_makes_no_cell_finer),
        cmocka_unit_test(what_contradicts_coarser_grids_is_believed),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
