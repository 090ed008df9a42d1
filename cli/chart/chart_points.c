// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_points.h"

#include "core/base/alloc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Smaller errors count as this one, so that they have a logarithm.
static const double LEAST_ERROR = 1e-9;

void chart_points_finish(struct chart_points *points)
{
    for (size_t i = 0; i < points->count; i++)
        free(points->list[i].quality);
    free(points->list);
    *points = (struct chart_points){0};
}

void chart_points_add(struct chart_points *points, const struct chart_point *point)
{
    points->list = xgrow(points->list, &points->capacity, points->count + 1, sizeof *points->list);
    points->list[points->count++] = *point;
}

const struct chart_point *chart_points_find(const struct chart_points *points, const char *series, int rung)
{
    for (size_t i = 0; i < points->count; i++)
        if (points->list[i].rung == rung && strcmp(points->list[i].series, series) == 0) return &points->list[i];
    return NULL;
}

static bool is_beaten(const struct chart_point *point, const struct chart_point *by)
{
    return by->outcome == CHART_MEASURED && by->seconds <= point->seconds && by->error <= point->error &&
           (by->seconds < point->seconds || by->error < point->error);
}

bool chart_points_is_best(const struct chart_points *points, size_t index)
{
    if (points->list[index].outcome != CHART_MEASURED) return false;
    for (size_t i = 0; i < points->count; i++)
        if (is_beaten(&points->list[index], &points->list[i])) return false;
    return true;
}

// The most exact point of a series below `seconds`.
static const struct chart_point *find_before(const struct chart_points *points, const char *series, double seconds)
{
    const struct chart_point *found = NULL;

    for (size_t i = 0; i < points->count; i++) {
        const struct chart_point *point = &points->list[i];

        if (point->outcome != CHART_MEASURED || strcmp(point->series, series) != 0 || point->seconds >= seconds)
            continue;
        if (!found || point->error < found->error) found = point;
    }
    return found;
}

// The fastest point of a series with at most that error.
static const struct chart_point *find_enough(const struct chart_points *points, const char *series, double error)
{
    const struct chart_point *found = NULL;

    for (size_t i = 0; i < points->count; i++) {
        const struct chart_point *point = &points->list[i];

        if (point->outcome != CHART_MEASURED || strcmp(point->series, series) != 0 || point->error > error) continue;
        if (!found || point->seconds < found->seconds) found = point;
    }
    return found;
}

double chart_points_time(const struct chart_points *points, const char *series, double error)
{
    const struct chart_point *enough = find_enough(points, series, error), *before;
    double low, high, share;

    if (!enough) return NAN;
    before = find_before(points, series, enough->seconds);
    if (!before) return enough->seconds;
    low = log(fmax(enough->error, LEAST_ERROR));
    high = log(before->error);
    share = (high - log(error)) / (high - low);
    return before->seconds * pow(enough->seconds / before->seconds, share);
}
