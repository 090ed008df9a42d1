// The cheapest paths that keep an error, on known errors.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/scatter_terrain.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static void what_is_found_keeps_the_target_and_is_cheap(void **state)
{
    static const double targets[] = {0.003, 0.01, 0.03, 0.1}, cells[] = {0.05, 1.0, 4.0, 20.0};

    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++)
        for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
            struct scatter_terrain terrain = {.cells = cells[k], .noise = 5.0, .pixel_noise = 1.3};
            struct scatter_finding found = scatter_terrain_search(&terrain, targets[i], true);

            assert_true(found.is_found);
            assert_true(scatter_terrain_found_square(&terrain, &found) <= 1.001 * targets[i] * targets[i]);
            assert_true(scatter_terrain_cost(found.setting.grid_rung, found.setting.path_rung) <=
                        4.0 * scatter_terrain_least_cost(&terrain, targets[i]));
        }
}

// Grids that the noise alone makes dearer than what was found are not tried. What is found knows how much of its error
// is cells.
static void what_cannot_be_cheaper_is_left_early(void **state)
{
    struct scatter_terrain terrain = {.cells = 4.0, .noise = 5.0, .pixel_noise = 1e3};
    struct scatter_finding found = scatter_terrain_search(&terrain, 0.01, true);
    double cells = scatter_terrain_square(&terrain, found.setting.grid_rung, 120);

    (void)state;
    assert_true(found.is_found);
    assert_float_equal(found.cells, cells, 0.1 * cells);
    assert_int_equal(terrain.finest, found.setting.grid_rung);
}

// Every grid costs more than paths of pixels by its noise, and those that may be tried first have too large cells.
static void grids_that_are_dear_by_noise_have_no_finer_ones(void **state)
{
    struct scatter_terrain terrain = {.cells = 20.0, .noise = 40.0, .pixel_noise = 1.0, .seen = 1.0, .length = 8.0};
    struct scatter_finding found = scatter_terrain_search_within(&terrain, 0.02, true, 5e5);

    (void)state;
    assert_true(found.is_found);
    assert_int_equal(found.setting.grid_rung, SCATTER_PIXELS);
    assert_int_equal(scatter_grid_cells[terrain.finest], 16); // the last before paths of pixels are tried
}

// A particle costs as much as two and a half walks.
static void the_lights_fill_a_grid_where_that_costs_less(void **state)
{
    static const struct {
        double noise; // relative to that of walks
        bool is_chosen;
    } rows[] = {{1.0, false}, {0.5, false}, {0.15, true}, {0.02, true}};

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct scatter_terrain terrain = {
            .cells = 1.0, .noise = 40.0, .pixel_noise = 1e4, .lights_noise = rows[i].noise};
        struct scatter_finding found = scatter_terrain_search(&terrain, 0.01, true);
        double cells = scatter_terrain_square(&terrain, found.setting.grid_rung, 120);
        double noise = scatter_terrain_found_square(&terrain, &found) - cells;

        assert_int_equal(found.setting.is_from_lights, rows[i].is_chosen);
        assert_true(terrain.lights_measured > 0 && terrain.lights_measured <= 2);
        assert_true(cells + noise * (rows[i].is_chosen ? rows[i].noise : 1.0) <= 1.001e-4);
    }
    (void)state;
}

// Another way has programs to link, and a trial of its own.
static void a_cheap_grid_is_filled_as_it_comes(void **state)
{
    struct scatter_terrain terrain = {.cells = 0.5, .noise = 0.1, .pixel_noise = 1e4, .lights_noise = 0.01};

    assert_false(scatter_terrain_search(&terrain, 0.03, true).setting.is_from_lights);
    assert_int_equal(terrain.lights_measured, 0);
    (void)state;
}

// Nodes that the camera hardly sees have few walks: the search may look at grids that are finer for it.
static void hidden_nodes_are_not_paid_for(void **state)
{
    struct scatter_terrain open = {.cells = 12.0, .noise = 25.0, .pixel_noise = 600.0}, hidden = open;
    struct scatter_finding dear = scatter_terrain_search_within(&open, 0.01, true, 6e6), found;

    hidden.seen = 0.05;
    hidden.length = 1.0;
    found = scatter_terrain_search_within(&hidden, 0.01, true, 6e6);
    assert_true(found.is_found && found.paths < 0.2 * dear.paths);
    assert_true(fabs(found.paths - 0.05 * scatter_terrain_cost(found.setting.grid_rung, found.setting.path_rung)) <
                1e-2 * found.paths);
    (void)state;
}

// Paths that are scattered a thousand times take a thousand looks, from pixels as from nodes.
static void long_walks_cost_what_they_take(void **state)
{
    struct scatter_terrain usual = {.cells = 4.0, .noise = 25.0, .pixel_noise = 60.0, .seen = 1.0, .length = 1.0};
    struct scatter_terrain longer = usual;
    struct scatter_finding found = scatter_terrain_search_within(&usual, 0.01, true, 6e7), dear;

    longer.length = 30.0;
    dear = scatter_terrain_search_within(&longer, 0.01, true, 6e7);
    assert_true(dear.paths > 10.0 * found.paths);
    assert_true(longer.length * longer.traced < 0.3 * dear.paths);
    (void)state;
}

// Paths of pixels may be much shorter than walks that begin deep inside, and cost what they take.
static void short_paths_of_pixels_are_chosen(void **state)
{
    struct scatter_terrain alike = {.cells = 4.0, .noise = 25.0, .pixel_noise = 60.0, .seen = 1.0, .length = 8.0};
    struct scatter_terrain shorter = alike;
    struct scatter_finding found = scatter_terrain_search(&alike, 0.01, true);

    alike.pixel_length = 8.0;
    shorter.pixel_length = 0.1;
    assert_true(found.setting.grid_rung >= 0);
    assert_true(scatter_terrain_search(&alike, 0.01, true).setting.grid_rung >= 0);
    found = scatter_terrain_search(&shorter, 0.01, true);
    assert_int_equal(found.setting.grid_rung, SCATTER_PIXELS);
    assert_true(fabs(found.paths - 0.1 * scatter_terrain_cost(SCATTER_PIXELS, found.setting.path_rung)) <
                1e-2 * found.paths);
    (void)state;
}

// The first grid is not measured well where its noise alone makes it dearer than paths of pixels.
static void a_noisy_grid_is_left_for_pixels(void **state)
{
    struct scatter_terrain terrain = {.cells = 0.1, .noise = 4000.0, .pixel_noise = 1.0};

    assert_int_equal(scatter_terrain_search(&terrain, 0.02, true).setting.grid_rung, SCATTER_PIXELS);
    assert_int_equal(terrain.most_of_few, 8); // with which each grid begins
    (void)state;
}

// A trial that takes as long as it saves is left out where only one frame has it.
static void trials_are_repaid_by_frames(void **state)
{
    struct scatter_terrain many = {.cells = 12.0, .noise = 25.0, .pixel_noise = 100.0}, one = many;
    struct scatter_finding dear, cheap = scatter_terrain_search(&many, 0.01, true);

    one.frames = 1.0;
    dear = scatter_terrain_search(&one, 0.01, true);
    assert_true(cheap.is_found && dear.is_found);
    assert_true(dear.paths < 3.0 * cheap.paths);
    assert_true(one.traced + dear.paths < many.traced + cheap.paths);
    (void)state;
}

static void light_that_no_grid_holds_gets_paths_of_pixels(void **state)
{
    struct scatter_terrain rough = {.cells = 1e4, .noise = 5.0, .pixel_noise = 1.3}, smooth = rough;
    struct scatter_finding found = scatter_terrain_search(&rough, 0.01, true);

    smooth.cells = 1.0;
    assert_true(found.is_found && found.setting.grid_rung == SCATTER_PIXELS);
    assert_int_equal(found.setting.path_rung, (int)ceil(2.0 * log2(1.3 / 1e-4)));
    assert_true(scatter_terrain_search(&smooth, 0.01, true).setting.grid_rung >= 0);
    assert_int_equal(scatter_terrain_search(&smooth, 0.01, false).setting.grid_rung, SCATTER_PIXELS);
}

// A thick cloud: a grid that keeps the target takes more paths than the search may trace, pixels a thousand times more.
static void a_grid_too_fine_to_be_tried_is_found_by_coarser_ones(void **state)
{
    static const double targets[] = {0.01, 0.013, 0.02};

    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
        struct scatter_terrain thick = {.cells = 12.0, .noise = 25.0, .pixel_noise = 600.0};
        struct scatter_finding found = scatter_terrain_search_within(&thick, targets[i], true, 6e6);

        assert_true(found.is_found && found.setting.grid_rung >= 0);
        assert_true(scatter_terrain_found_square(&thick, &found) <= 1.2 * targets[i] * targets[i]);
        assert_true(scatter_terrain_cost(found.setting.grid_rung, found.setting.path_rung) <=
                    4.0 * scatter_terrain_least_cost(&thick, targets[i]));
    }
    (void)state;
}

// Where cells are too large, more paths of their nodes would tell nothing: what may be traced is left for finer ones.
static void paths_are_not_spent_on_cells_that_are_too_large(void **state)
{
    struct scatter_terrain terrain = {.cells = 100.0, .noise = 160.0, .pixel_noise = 1e3};
    struct scatter_finding found = scatter_terrain_search_within(&terrain, 0.03, true, 6e7);

    assert_true(found.is_found && scatter_grid_cells[found.setting.grid_rung] >= 64);
    assert_true(terrain.most_of_few <= 16);
    assert_true(scatter_terrain_found_square(&terrain, &found) <= 1.001 * 0.03 * 0.03);
    (void)state;
}

// A frame whose pixels need many paths is worth a longer search for a grid.
static void a_search_costs_what_a_frame_allows(void **state)
{
    struct scatter_terrain dear = {.cells = 600.0, .noise = 0.1, .pixel_noise = 400.0}, cheap = dear;

    cheap.pixel_noise = 0.01;
    assert_true(scatter_terrain_search_within(&dear, 0.03, true, 1e6).setting.grid_rung >= 0);
    assert_true(dear.traced < 0.3 * scatter_terrain_cost(SCATTER_PIXELS, (int)ceil(2.0 * log2(400.0 / 0.03 / 0.03))));
    assert_int_equal(scatter_terrain_search_within(&cheap, 0.03, true, 1e6).setting.grid_rung, SCATTER_PIXELS);
    assert_true(cheap.traced <= 1e6);
    (void)state;
}

static void no_grid_beyond_128_cells_is_chosen_untried(void **state)
{
    for (double cells = 20.0; cells < 400.0; cells *= 1.5) {
        struct scatter_terrain thick = {.cells = cells, .noise = 0.01, .pixel_noise = 1e4};
        struct scatter_finding found = scatter_terrain_search_within(&thick, 0.01, true, 6e6);

        assert_true(!found.is_found || scatter_terrain_found_square(&thick, &found) <= 1.2 * 0.01 * 0.01);
        assert_true(found.setting.grid_rung < 0 || scatter_grid_cells[found.setting.grid_rung] <= 128 ||
                    found.setting.grid_rung <= thick.finest);
    }
    (void)state;
}

static void the_nearest_is_kept_where_nothing_suffices(void **state)
{
    struct scatter_terrain noisy = {.cells = 1e4, .noise = 1e6, .pixel_noise = 1e6};
    struct scatter_finding found = scatter_terrain_search(&noisy, 0.001, true);

    assert_false(found.is_found);
    assert_true(isfinite(found.error) && found.error > 0.001);
    noisy = (struct scatter_terrain){.cells = 0.1, .noise = 1e12, .pixel_noise = 1e15, .lights_noise = 0.9};
    assert_false(scatter_terrain_search_within(&noisy, 0.001, true, 1e6).is_found);
    assert_int_equal(noisy.lights_measured, 1);
    assert_true(noisy.traced < 2e6); // two pictures a measurement
}

static void a_search_ends_where_it_is_stopped(void **state)
{
    struct scatter_terrain terrain = {.cells = 1.0, .noise = 5.0, .pixel_noise = 1.3, .stop_after = 3};

    assert_true(scatter_terrain_search(&terrain, 0.01, true).is_stopped);
    assert_int_equal(terrain.measured, 3);
}

// What is cheap is refined: both parts of the error fall, and the paths stay within what is allowed.
static void what_is_cheap_is_refined(void **state)
{
    struct scatter_finding grid = {
        .setting = {.grid_rung = 4, .path_rung = 8}, .error = 0.05, .cells = 1e-3, .paths = 1e5, .is_found = true};
    struct scatter_finding dear = grid, pixels = grid, missed = grid;

    (void)state;
    scatter_finding_refine(&grid, 5.3e5);
    assert_int_equal(grid.setting.grid_rung, 5);
    assert_int_equal(grid.setting.path_rung, 10);
    assert_float_equal(grid.paths, 2e5 * pow(22.0 / 16.0, 3.0), 1.0);
    assert_float_equal(grid.cells, 1e-3 / pow(22.0 / 16.0, 2.5), 1e-9);
    assert_float_equal(grid.error * grid.error - grid.cells, 1.5e-3 / 2.75, 1e-9);
    scatter_finding_refine(&dear, 5.1e5);
    assert_int_equal(dear.setting.grid_rung, 4);
    assert_float_equal(dear.error, 0.05, 1e-12);
    pixels.setting.grid_rung = SCATTER_PIXELS;
    pixels.cells = 0.0;
    scatter_finding_refine(&pixels, 4.1e5);
    assert_int_equal(pixels.setting.grid_rung, SCATTER_PIXELS);
    assert_int_equal(pixels.setting.path_rung, 12);
    assert_float_equal(pixels.error, 0.025, 1e-12);
    // What misses its target has other reasons.
    missed.is_found = false;
    scatter_finding_refine(&missed, 1e9);
    assert_int_equal(missed.setting.grid_rung, 4);
    // No grid is chosen untried that may take too much memory.
    scatter_finding_refine(&grid, 1e15);
    assert_true(scatter_grid_cells[grid.setting.grid_rung] <= 128);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_found_keeps_the_target_and_is_cheap),
        cmocka_unit_test(what_cannot_be_cheaper_is_left_early),
        cmocka_unit_test(grids_that_are_dear_by_noise_have_no_finer_ones),
        cmocka_unit_test(the_lights_fill_a_grid_where_that_costs_less),
        cmocka_unit_test(a_cheap_grid_is_filled_as_it_comes),
        cmocka_unit_test(hidden_nodes_are_not_paid_for),
        cmocka_unit_test(long_walks_cost_what_they_take),
        cmocka_unit_test(short_paths_of_pixels_are_chosen),
        cmocka_unit_test(a_noisy_grid_is_left_for_pixels),
        cmocka_unit_test(trials_are_repaid_by_frames),
        cmocka_unit_test(light_that_no_grid_holds_gets_paths_of_pixels),
        cmocka_unit_test(a_grid_too_fine_to_be_tried_is_found_by_coarser_ones),
        cmocka_unit_test(paths_are_not_spent_on_cells_that_are_too_large),
        cmocka_unit_test(a_search_costs_what_a_frame_allows),
        cmocka_unit_test(no_grid_beyond_128_cells_is_chosen_untried),
        cmocka_unit_test(the_nearest_is_kept_where_nothing_suffices),
        cmocka_unit_test(a_search_ends_where_it_is_stopped),
        cmocka_unit_test(what_is_cheap_is_refined),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
