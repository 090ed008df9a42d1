// The settings that a chart tries: for each method a ladder from coarse to fine, and the rule that ends it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct chart_points;
struct error;
struct json_node;

enum { CHART_RUNG_LIMIT = 20 }; // rungs of a ladder are [0, CHART_RUNG_LIMIT)

// The lengths of the scene that steps are derived from, in metres.
struct chart_scale {
    double near, far; // the interval in which camera rays meet media; far may be INFINITY
    double length;    // extent of the smallest medium
    double voxel;     // the shortest edge of the finest grid; 0: there is none
};

// The limits of a ladder.
struct chart_limits {
    double seconds; // the longest time of a picture
    double error;   // smaller errors cannot be told apart
    bool is_short;  // leaves out ladders of samples unless they are named: each of their rungs needs its own truth
};

// Series are numbered from 0. A series is a method with one free number, on which its other numbers depend.
size_t chart_ladder_count(void);
const char *chart_ladder_name(size_t series);
const char *chart_ladder_method(size_t series);
// True when it needs camera.clip.
bool chart_ladder_needs_clip(size_t series);
// The series with which this one coincides, rung by rung, in scenes without the feature that it adds; -1: none.
int chart_ladder_base(size_t series);
// The quality of a rung as JSON, owned by the caller. Samples and limits of paths are kept from `quality`, the job's
// own, which may be absent.
char *chart_ladder_quality(size_t series, int rung, const struct chart_scale *scale, const struct json_node *quality);
// The quality of a job that states a tolerance in place of a method.
char *chart_ladder_tolerance(double tolerance, const struct json_node *quality);
// The rung to try next. -1 ends the ladder: the next picture would take far longer than the limit, or the last one did,
// its error is too small to measure, the error no more decreases, or a rung was refused after others were measured.
int chart_ladder_next(const struct chart_points *points, size_t series, const struct chart_limits *limits);

struct chart_choice_name {
    char *name; // owned; that of a series or a method
    int rung;   // -1: all
};

// The choice of --methods; the zero value is all.
struct chart_choice {
    struct chart_choice_name *names; // owned
    size_t count;
};

// The name of the planner's choice among series.
extern const char CHART_PLANNED[];

// Reads "riemann,gauss 4,cached:7,auto".
bool chart_choice_parse(struct chart_choice *choice, const char *text, struct error *error);
void chart_choice_finish(struct chart_choice *choice);
// As chart_ladder_next, for the chosen rungs only.
int chart_choice_next(const struct chart_choice *choice, const struct chart_points *points, size_t series,
                      const struct chart_limits *limits);
// True when the planner's choice is included.
bool chart_choice_has_planned(const struct chart_choice *choice);
