// SPDX-License-Identifier: Apache-2.0
#include "tests/support/scatter_terrain.h"

#include <math.h>

static const double PIXELS = 160.0 * 120.0;

// A factor of 0.5 to 1.7 or so, 1 in the mean: the mean of four exponential numbers.
static double draw_luck(struct scatter_terrain *terrain)
{
    double sum = 0.0;

    for (int i = 0; i < 4; i++) {
        terrain->luck = terrain->luck * 1664525u + 1013904223u;
        sum -= log((terrain->luck >> 8) / 16777216.0 + 1e-9);
    }
    return sum / 4.0;
}

double scatter_terrain_square(const struct scatter_terrain *terrain, int grid_rung, int path_rung)
{
    double cells;

    if (grid_rung == SCATTER_PIXELS) return terrain->pixel_noise * exp2(-0.5 * path_rung);
    cells = terrain->cells / pow(scatter_grid_cells[grid_rung], 2.0);
    return cells * cells + terrain->skin + terrain->noise * exp2(-0.5 * path_rung) / scatter_grid_cells[grid_rung];
}

static bool measure(void *user, const struct scatter_setting *setting, struct scatter_measured *measured)
{
    struct scatter_terrain *terrain = user;
    int grid_rung = setting->grid_rung, path_rung = setting->path_rung;
    double cells = scatter_terrain_square(terrain, grid_rung, 120),
           noise = scatter_terrain_square(terrain, grid_rung, path_rung) - cells;

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

struct scatter_finding scatter_terrain_search_within(struct scatter_terrain *terrain, double target, bool has_grid,
                                                     double path_max)
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

struct scatter_finding scatter_terrain_search(struct scatter_terrain *terrain, double target, bool has_grid)
{
    return scatter_terrain_search_within(terrain, target, has_grid, 1e9);
}

double scatter_terrain_found_square(const struct scatter_terrain *terrain, const struct scatter_finding *found)
{
    return scatter_terrain_square(terrain, found->setting.grid_rung, found->setting.path_rung);
}

double scatter_terrain_cost(int grid_rung, int path_rung)
{
    return (grid_rung == SCATTER_PIXELS ? PIXELS : pow(scatter_grid_cells[grid_rung], 3.0)) * exp2(0.5 * path_rung);
}

double scatter_terrain_least_cost(const struct scatter_terrain *terrain, double target)
{
    double least = INFINITY;

    for (int grid = SCATTER_PIXELS; grid < SCATTER_GRID_RUNGS; grid++)
        for (int path = 0; path < SCATTER_PATH_RUNGS; path++)
            if (scatter_terrain_square(terrain, grid, path) <= target * target)
                least = fmin(least, scatter_terrain_cost(grid, path));
    return least;
}
