// A chart's points as a CSV file, from which a stopped chart can be continued.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct chart_points;
struct error;

// Writes RFC 4180: a line of titles, then one for each point. A reader never sees a partial file.
bool chart_csv_save(const struct chart_points *points, const char *path, struct error *error);
// Adds the file's points to `points`, in which only the facts are set. A missing file has no points. A file with other
// facts, or in another format, is an error.
bool chart_csv_load(struct chart_points *points, const char *path, struct error *error);
