// Settings of methods that were tried on one picture, and what came of each: seconds and error, or why not.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/job.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    CHART_SERIES_SIZE = 32,
    CHART_TEXT_SIZE = 160, // of a reason, and of what names the GL that rendered
};

// What all points of a chart have in common.
struct chart_facts {
    char name[JOB_NAME_LIMIT + 1]; // the job's
    char scene[HASH_TEXT_SIZE];    // of all that the truth depends on
    int64_t frame;
    int64_t width_px, height_px;
    char backend[16], renderer[CHART_TEXT_SIZE];
};

enum chart_outcome {
    CHART_MEASURED,
    CHART_REFUSED, // the method, or this setting of it, cannot render the scene
    CHART_TOO_SLOW // one picture takes longer than the limit
};

struct chart_point {
    char series[CHART_SERIES_SIZE]; // chart_ladder_name
    int rung;                       // of its ladder, from the coarsest
    char *quality;                  // owned; JSON, as a job has it
    enum chart_outcome outcome;
    double seconds;       // a picture, once programs are warm; of one that is too slow: the limit
    int64_t repeats;      // whose median that is
    char timer[8];        // "gpu" or "wall"
    double error;         // relative RMSE
    double largest_error; // of a value
    char truth[16];       // what the error is against: "reference" or "midpoint"
    int64_t pixels;       // in which it was measured
    char reason[CHART_TEXT_SIZE];
};

// The zero value is empty.
struct chart_points {
    struct chart_facts facts;
    struct chart_point *list; // owned
    size_t count, capacity;
};

void chart_points_finish(struct chart_points *points);
// Takes the point's quality over.
void chart_points_add(struct chart_points *points, const struct chart_point *point);
// NULL when it was not tried.
const struct chart_point *chart_points_find(const struct chart_points *points, const char *series, int rung);
// True when no other measured point is as fast and as exact, and one of them better.
bool chart_points_is_best(const struct chart_points *points, size_t index);
// Seconds in which a series reaches the error, by straight lines between its best points in the logarithms of both; that of
// its fastest point where that is exact enough already. NAN when it never is.
double chart_points_time(const struct chart_points *points, const char *series, double error);
