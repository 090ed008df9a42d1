// Measures the points of a chart with a worker of its own. Points in the chart's files are not measured again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/chart/chart_points.h"
#include "cli/chart/chart_svg.h"
#include "cli/program/exit_status.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct json_node;
struct options;

struct chart_session_params {
    const struct options *options; // --methods, --quick, --point-limit and the options for workers
    const char *document;          // borrowed; the job, in the chart's size
    int64_t frame;
    const char *csv_path, *svg_path, *png_path, *truth_path; // absolute
    // Called for each new point; for consecutive refused ones of a series, once.
    void (*on_point)(void *user, const struct chart_point *point);
    void *user;
};

// Whatever the status, `points` and the files have all that was measured. `mark` receives the job's tolerance and the
// planner's choice for it.
enum exit_status chart_session_run(const struct chart_session_params *params, struct chart_points *points,
                                   struct chart_svg_mark *mark, struct error *error);
