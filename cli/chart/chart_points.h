// The points of a chart: settings of methods tried on one picture, with seconds and error, or why there are none.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/job.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    CHART_SERIES_SIZE = 32,
    CHART_TEXT_SIZE = 160, // of a reason, and of the name of a GL renderer
};

// What all points of a chart have in common.
struct chart_facts {
    char name[JOB_NAME_LIMIT + 1]; // the job's
    char scene[HASH_TEXT_SIZE];    // the hash of everything that the truth depends on
    int64_t frame;
    int64_t width_px, height_px;
    char backend[16], renderer[CHART_TEXT_SIZE];
};

enum chart_outcome {
    CHART_MEASURED,
    CHART_REFUSED, // the method, or this setting of it, cannot render the scene
    CHART_TOO_SLOW // a picture takes longer than the limit
};

struct chart_point {
    char series[CHART_SERIES_SIZE]; // chart_ladder_name
    int rung;                       // on its ladder, 0 is the coarsest
    char *quality;                  // owned; JSON, as a job has it
    enum chart_outcome outcome;
    double seconds;       // for a picture, programs being compiled; the limit when too slow
    int64_t repeats;      // `seconds` is their median
    char timer[8];        // "gpu" or "wall"
    double error;         // relative RMSE
    double largest_error; // of a single value
    char truth[16];       // what the picture was compared with: "reference" or "midpoint"
    int64_t pixels;       // compared
    char reason[CHART_TEXT_SIZE];
};

// The zero value is empty.
struct chart_points {
    struct chart_facts facts;
    struct chart_point *list; // owned
    size_t count, capacity;
};

void chart_points_finish(struct chart_points *points);
// Takes over the point's quality.
void chart_points_add(struct chart_points *points, const struct chart_point *point);
// NULL when it was not tried.
const struct chart_point *chart_points_find(const struct chart_points *points, const char *series, int rung);
// True on the Pareto front: no other measured point is at least as fast and as exact, and better in one of both.
bool chart_points_is_best(const struct chart_points *points, size_t index);
// The seconds in which a series reaches `error`: interpolated linearly between its best points, in the logarithms of
// both; those of its fastest point where that is exact enough. NAN when no point is.
double chart_points_time(const struct chart_points *points, const char *series, double error);
