// A logarithmic axis: the positions of values, and the labels of its decades.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

// The whole decades that contain all added values. The zero value has none.
struct chart_axis {
    int first, last; // 10^first to 10^last
    size_t count;    // of values
};

// Ignores values that are not finite and positive.
void chart_axis_add(struct chart_axis *axis, double value);
// The position of a value: [0, 1] within the axis, outside it beyond. The axis spans at least one decade.
double chart_axis_position(const struct chart_axis *axis, double value);

enum { CHART_LABEL_SIZE = 24 };
void chart_axis_format_seconds(double seconds, char label[static CHART_LABEL_SIZE]); // "10 ms"
void chart_axis_format_percent(double share, char label[static CHART_LABEL_SIZE]);   // "0.1 %"
