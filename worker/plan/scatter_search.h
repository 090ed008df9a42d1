// Finds the cheapest random paths that keep an error: those of a grid's nodes, or those of each pixel. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

enum {
    SCATTER_GRID_RUNGS = 13,
    SCATTER_PATH_RUNGS = 21, // 2^rung paths: 1 to JOB_PATH_LIMIT
    SCATTER_PIXELS = -1      // in place of a grid: paths of each pixel
};

// The least number of cells first.
extern const int scatter_grid_cells[SCATTER_GRID_RUNGS];

struct scatter_search {
    double target;      // the relative RMSE to keep
    double pixels;      // of a frame, times their samples
    bool has_grid;      // else only pixels have paths
    double path_max;    // paths that may be traced for all measurements together
    double list_pixels; // that a measurement traces
    // Measures the square of the relative RMSE with 2^path_rung paths of each node of that grid (or SCATTER_PIXELS); it
    // may be negative, and INFINITY where that cannot be rendered. False ends the search.
    bool (*measure)(void *user, int grid_rung, int path_rung, double *square);
    void *user;
};

struct scatter_finding {
    int grid_rung; // or SCATTER_PIXELS
    int path_rung;
    double error; // expected
    bool is_found, is_stopped;
};

// The squared error is that of the grid's cells, which no number of paths changes, and a variance over the number of
// paths: two measurements tell both. A grid that is too fine to be tried is found by those that are too coarse.
struct scatter_finding scatter_search_run(const struct scatter_search *search);
