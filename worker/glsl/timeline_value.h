// Frame values that follow one timeline of the job.
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
// The same of a place in the world, m.
struct frame_value timeline_value_position(const struct timeline *timeline, const char *meaning);
// The frame's time: "time_s" in shaders that ask for it.
struct frame_value timeline_value_time(void);
// What such a value is: `source` is the timeline; a single number fills three components.
void timeline_value_evaluate(const void *source, double time, double value[static 9]);
// The vector's way only; a null vector gives NaN, which packing refuses.
void timeline_value_evaluate_unit(const void *source, double time, double value[static 9]);
// True when it is 0 in all components at all times.
bool timeline_value_is_zero(const struct timeline *timeline);
// True when its three components are always equal.
bool timeline_value_is_grey(const struct timeline *timeline);
