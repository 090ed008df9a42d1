// Measures the points of a chart with a worker of our own: what is in its files is not measured again.
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
    const struct options *options; // whose --methods, --quick, --point-limit and worker's options count
    const char *document;          // the job's, of the chart's size; borrowed
    int64_t frame;
    const char *csv_path, *svg_path, *png_path, *truth_path; // absolute
    // Called for each new point; of a series that is refused once, for the first.
    void (*on_point)(void *user, const struct chart_point *point);
    void *user;
};

// Whatever it returns, `points` hold what was measured, and so do the files. `mark` receives the job's tolerance and what the
// planner chose for it.
enum exit_status chart_session_run(const struct chart_session_params *params, struct chart_points *points,
                                   struct chart_svg_mark *mark, struct error *error);
