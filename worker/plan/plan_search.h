// Looks for the cheapest setting of some axes that keeps an error: a walk that measures as it goes. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

enum { PLAN_AXIS_LIMIT = 5, PLAN_MEASURE_LIMIT = 40 };

// A rung of each axis: 0 is the coarsest, and two rungs halve a step.
struct plan_point {
    int rungs[PLAN_AXIS_LIMIT];
};

enum plan_measured {
    PLAN_MEASURED,
    PLAN_CANNOT, // not at this point
    PLAN_STOPPED // the whole search is over
};

struct plan_search {
    int axis_count;
    int last_rung[PLAN_AXIS_LIMIT];
    struct plan_point start;
    double target;     // the error to keep
    double work_limit; // what costs as much is not looked at
    double (*work)(void *user, const struct plan_point *point);
    enum plan_measured (*measure)(void *user, const struct plan_point *point, double *error);
    void *user;
};

enum plan_found {
    PLAN_FOUND,
    PLAN_OVER_LIMIT, // beyond the limit of work
    PLAN_MISSED,     // the best it has is over the target
    PLAN_GAVE_UP     // stopped
};

struct plan_finding {
    enum plan_found found;
    struct plan_point point; // the cheapest that keeps the target, or what came nearest
    double error, work;      // of that
    int measured;            // points
};

// Every point follows from errors and work alone.
struct plan_finding plan_search_run(const struct plan_search *search);
