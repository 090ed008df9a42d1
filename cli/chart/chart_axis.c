// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_axis.h"

#include <math.h>
#include <stdio.h>

// Makes a power of ten, despite rounding, the end of its decade and not part of the next.
static const double SLACK = 1e-9;

void chart_axis_add(struct chart_axis *axis, double value)
{
    int first, last;

    if (!(value > 0.0) || !isfinite(value)) return;
    first = (int)floor(log10(value) + SLACK);
    last = (int)ceil(log10(value) - SLACK);
    if (axis->count == 0 || first < axis->first) axis->first = first;
    if (axis->count == 0 || last > axis->last) axis->last = last;
    axis->count++;
}

double chart_axis_position(const struct chart_axis *axis, double value)
{
    int decades = axis->last > axis->first ? axis->last - axis->first : 1;

    return (log10(value) - axis->first) / decades;
}

void chart_axis_format_seconds(double seconds, char label[static CHART_LABEL_SIZE])
{
    if (seconds < 0.9995e-3)
        snprintf(label, CHART_LABEL_SIZE, "%.3g µs", seconds * 1e6);
    else if (seconds < 0.9995)
        snprintf(label, CHART_LABEL_SIZE, "%.3g ms", seconds * 1e3);
    else
        snprintf(label, CHART_LABEL_SIZE, seconds < 1000 ? "%.3g s" : "%.0f s", seconds);
}

void chart_axis_format_percent(double share, char label[static CHART_LABEL_SIZE])
{
    snprintf(label, CHART_LABEL_SIZE, share < 9.995 ? "%.3g %%" : "%.0f %%", share * 100.0);
}
