// A chart's picture: seconds against error, both in decades, a line a method, readable on light and on dark.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct chart_points;
struct error;

struct chart_svg_mark {
    double tolerance; // drawn as a line; 0: none
    // What the planner chose for it, drawn as a star; 0: it was not asked.
    double seconds, error;
    const char *label; // borrowed; of the star; its method and numbers
};

// The text of an SVG file, owned by the caller. Of no measured points it is an empty chart that says so. The best points of
// all, the Pareto front, are joined by a band.
char *chart_svg_format(const struct chart_points *points, const struct chart_svg_mark *mark);
bool chart_svg_save(const struct chart_points *points, const struct chart_svg_mark *mark, const char *path,
                    struct error *error);
