// Which settings of which methods a chart tries: for each method a ladder from coarse to fine, and where its climb ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct chart_points;
struct error;
struct json_node;

enum { CHART_RUNG_LIMIT = 20 }; // rungs of a ladder are [0, CHART_RUNG_LIMIT)

// What steps are measured by, in metres.
struct chart_scale {
    double near, far; // between which camera rays meet media; far is INFINITY where they do not end
    double length;    // across the smallest medium
    double voxel;     // the shortest edge of the finest grid; 0: there is none
};

// How far a ladder is climbed.
struct chart_limits {
    double seconds; // that a picture may take
    double error;   // below it more exact is not told from less
    bool
        is_short; // ladders of samples, each rung of which has a truth of its own, are climbed only where they are named
};

// Series are numbered from 0; one is a method with all but one of its numbers tied to that one.
size_t chart_ladder_count(void);
const char *chart_ladder_name(size_t series);
const char *chart_ladder_method(size_t series);
// True when it needs camera.clip.
bool chart_ladder_needs_clip(size_t series);
// The series of which this one's rungs are pictures over again where what it does otherwise is not there to do; -1: none.
int chart_ladder_plainer(size_t series);
// The quality of a rung as JSON, owned by the caller. `quality` is the job's own, or absent: what it says of samples and paths
// is kept.
char *chart_ladder_quality(size_t series, int rung, const struct chart_scale *scale, const struct json_node *quality);
// The same of a job that states a tolerance in place of a method.
char *chart_ladder_wish(double tolerance, const struct json_node *quality);
// The rung to try next; -1 when the climb is over: the next picture would take far longer than the limit, or the last one did, it
// became as exact as can be told, stopped becoming more exact, or was refused behind rungs that were not.
int chart_ladder_next(const struct chart_points *points, size_t series, const struct chart_limits *limits);

struct chart_choice_name {
    char *name; // owned; of a series or a method
    int rung;   // -1: all
};

// What --methods asks for; the zero value asks for all.
struct chart_choice {
    struct chart_choice_name *names; // owned
    size_t count;
};

// What the planner's choice goes by among series and names.
extern const char CHART_PLANNED[];

// Reads "riemann,gauss 4,cached:7,auto".
bool chart_choice_parse(struct chart_choice *choice, const char *text, struct error *error);
void chart_choice_finish(struct chart_choice *choice);
// The rung to try next, as chart_ladder_next has it, of what is chosen.
int chart_choice_next(const struct chart_choice *choice, const struct chart_points *points, size_t series,
                      const struct chart_limits *limits);
// True when the planner's choice is chosen.
bool chart_choice_has_planned(const struct chart_choice *choice);
