// Frame values that follow from one timeline of the job.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/glsl/frame_uniforms.h"

#include <stdbool.h>

struct timeline;

struct value_range {
    double min, max;
};

extern const struct value_range value_range_any, value_range_not_negative, value_range_positive;

// `timeline` and `meaning` outlive the value.
struct frame_value timeline_value(const struct timeline *timeline, enum frame_value_type type, struct value_range range,
                                  const char *meaning);
// Makes the value of a point of the world, m.
struct frame_value timeline_value_position(const struct timeline *timeline, const char *meaning);
// Makes the value of the frame's time, "time_s" in shaders.
struct frame_value timeline_value_time(void);
// Evaluates a timeline, `source`; a single number fills three components.
void timeline_value_evaluate(const void *source, double time, double value[static 9]);
// Evaluates and normalizes a vector; a null vector gives NaN, which packing refuses.
void timeline_value_evaluate_unit(const void *source, double time, double value[static 9]);
// True when the timeline is 0 in all components at all times.
bool timeline_value_is_zero(const struct timeline *timeline);
// True when the three components are always equal.
bool timeline_value_is_grey(const struct timeline *timeline);
