// Finds the cheapest random paths that keep an error: those of a grid's nodes, or those of each pixel. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

enum {
    SCATTER_GRID_RUNGS = 13,
    SCATTER_PATH_RUNGS = 41, // 1 to JOB_PATH_LIMIT paths
    SCATTER_PIXELS = -1      // in place of a grid: paths of each pixel
};

// What a particle from the lights takes, in walks from nodes: docs/rendering.md has the measurements.
static const double SCATTER_PARTICLE = 2.5;

// The least number of cells first.
extern const int scatter_grid_cells[SCATTER_GRID_RUNGS];
// How often a walk of usual length looks at media.
static const double SCATTER_USUAL_STEPS = 64.0;

// 2^(rung / 2), rounded.
int scatter_paths_of(int path_rung);

struct scatter_setting {
    int grid_rung; // or SCATTER_PIXELS
    int path_rung;
    bool is_from_lights; // particles fill the grid, else what the scene has without a choice
};

// Parts of a picture's squared relative RMSE.
struct scatter_measured {
    double cells;  // what no number of paths changes; may be negative by chance
    double chance; // of `cells`: a standard error
    double noise;  // a variance over the number of paths; INFINITY where the setting cannot be rendered
    // Of one picture: walks from the nodes of a grid or paths of pixels, and these as if each were of a walk's usual
    // length. 0: not counted.
    double walks, usual_walks;
};

struct scatter_search {
    double target;      // the relative RMSE to keep
    double pixels;      // of a frame, times their samples
    double frames;      // that what is found serves
    bool has_grid;      // else only pixels have paths
    bool may_choose;    // a grid may be filled from the lights or from its nodes
    double path_max;    // paths of usual length that may be traced for all measurements together
    double list_pixels; // that a measurement traces
    // Measures a setting by two pictures. False ends the search.
    bool (*measure)(void *user, const struct scatter_setting *setting, struct scatter_measured *measured);
    void *user;
};

struct scatter_finding {
    struct scatter_setting setting;
    double error; // expected
    double cells; // of its square, the part that cells have; the rest is noise
    double paths; // of a frame, in walks of usual length from nodes
    bool is_found, is_stopped;
};

// Makes a setting that keeps its target finer for as long as a frame takes at most so many paths: errors of half the
// target are audited in a fraction of the time.
void scatter_finding_refine(struct scatter_finding *finding, double paths_most);
// A grid that is too fine to be tried is found by those that are too coarse.
struct scatter_finding scatter_search_run(const struct scatter_search *search);
