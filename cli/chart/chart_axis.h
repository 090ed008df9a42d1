// An axis of decades: where values lie on it, and what its decades are called.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

// Whole decades that hold all values put in. The zero value holds none.
struct chart_axis {
    int first, last; // 10^first to 10^last
    size_t count;    // of values
};

// Values that are not finite and positive are passed over.
void chart_axis_add(struct chart_axis *axis, double value);
// [0, 1] within the axis, beyond it outside of it; 0 to 1 spans at least one decade.
double chart_axis_place(const struct chart_axis *axis, double value);

enum { CHART_LABEL_SIZE = 24 };
void chart_axis_format_seconds(double seconds, char label[static CHART_LABEL_SIZE]); // "10 ms"
void chart_axis_format_percent(double share, char label[static CHART_LABEL_SIZE]);   // "0.1 %"
