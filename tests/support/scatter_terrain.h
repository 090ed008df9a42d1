// A search for the cheapest paths on known errors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/scatter_search.h"

#include <stdbool.h>

// The error of cells falls with their number's square. A pixel sees several nodes, each with the noise of its paths.
struct scatter_terrain {
    double cells, noise, pixel_noise;
    double skin;    // what no cells make smaller: added to their square
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

// The square of a setting's true error.
double scatter_terrain_square(const struct scatter_terrain *terrain, int grid_rung, int path_rung);
double scatter_terrain_found_square(const struct scatter_terrain *terrain, const struct scatter_finding *found);
// The paths of a frame.
double scatter_terrain_cost(int grid_rung, int path_rung);
// Those of the cheapest setting that keeps a target.
double scatter_terrain_least_cost(const struct scatter_terrain *terrain, double target);
// `path_max` as in struct scatter_search; where it isn't stated, no search ends by it.
struct scatter_finding scatter_terrain_search(struct scatter_terrain *terrain, double target, bool has_grid);
struct scatter_finding scatter_terrain_search_within(struct scatter_terrain *terrain, double target, bool has_grid,
                                                     double path_max);
