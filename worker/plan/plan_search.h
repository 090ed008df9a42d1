// Searches for the setting of some axes that keeps an error with the least work: a walk that measures as it goes. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

enum {
    PLAN_AXIS_LIMIT = 7,
    PLAN_MEASURE_LIMIT = 40, // points per search
    PLAN_HALVING_RUNGS = 2   // by which a step is halved
};

// A rung of each axis: 0 is the coarsest, and two rungs halve a step.
struct plan_point {
    int rungs[PLAN_AXIS_LIMIT];
    int is_from_lights; // 1: particles fill the grid of scattered light (job_quality.scatter_from); no search moves it
};

enum plan_measured {
    PLAN_MEASURED,
    PLAN_CANNOT, // this point cannot be measured
    PLAN_STOPPED // the whole search is over
};

struct plan_search {
    int axis_count;
    int last_rung[PLAN_AXIS_LIMIT];
    struct plan_point start;
    double target;     // the error to keep
    double work_limit; // points with as much work are not measured
    double (*work)(void *user, const struct plan_point *point);
    enum plan_measured (*measure)(void *user, const struct plan_point *point, double *error);
    void *user;
};

enum plan_found {
    PLAN_FOUND,
    PLAN_OVER_LIMIT, // no point within the work limit keeps the target
    PLAN_MISSED,     // no point keeps the target
    PLAN_GAVE_UP     // `measure` stopped the search
};

struct plan_finding {
    enum plan_found found;
    struct plan_point point; // the one with the least work that keeps the target, or the one that came nearest to it
    double error, work;      // of that point
    int measured;            // number of points
};

// The result depends on errors and work alone.
struct plan_finding plan_search_run(const struct plan_search *search);
