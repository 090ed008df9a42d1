// A chart as SVG: seconds against error, both logarithmic, a line for each method, readable on light and dark ground.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct chart_points;
struct error;

struct chart_svg_mark {
    double tolerance; // drawn as a line; 0: none
    // The planner's choice, drawn as a star; 0: none.
    double seconds, error;
    const char *label; // borrowed; of the star: method and numbers
};

// The text of an SVG file, owned by the caller. Without measured points it is an empty chart that says so. A band joins
// the best points, the Pareto front.
char *chart_svg_format(const struct chart_points *points, const struct chart_svg_mark *mark);
bool chart_svg_save(const struct chart_points *points, const struct chart_svg_mark *mark, const char *path,
                    struct error *error);
