// A chart's points as a CSV file, which is also where a chart that was stopped goes on from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct chart_points;
struct error;

// RFC 4180, a line a point below one of titles; written so that a reader never meets half of it.
bool chart_csv_save(const struct chart_points *points, const char *path, struct error *error);
// Adds the file's points to `points`, which is empty but for its facts. A file that is not there has none; one of other facts
// than those, or that is none of ours, is an error.
bool chart_csv_load(struct chart_points *points, const char *path, struct error *error);
