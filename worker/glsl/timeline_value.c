// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/timeline_value.h"

#include "core/scene/timeline.h"

#include <float.h>
#include <math.h>

const struct value_range value_range_any = {-FLT_MAX, FLT_MAX};
const struct value_range value_range_not_negative = {0, FLT_MAX};
const struct value_range value_range_positive = {FLT_MIN, FLT_MAX};

void timeline_value_evaluate(const void *source, double time, double value[static 9])
{
    const struct timeline *timeline = source;

    timeline_evaluate(timeline, time, value);
    if (timeline->component_count == 1) value[1] = value[2] = value[0];
}

void timeline_value_evaluate_unit(const void *source, double time, double value[static 9])
{
    double length;

    timeline_value_evaluate(source, time, value);
    length = hypot(hypot(value[0], value[1]), value[2]);
    for (int i = 0; i < 3; ++i)
        value[i] /= length;
}

struct frame_value timeline_value(const struct timeline *timeline, enum frame_value_type type, struct value_range range,
                                  const char *meaning)
{
    return (struct frame_value){.type = type,
                                .is_constant = timeline_is_constant(timeline),
                                .evaluate = timeline_value_evaluate,
                                .source = timeline,
                                .min = range.min,
                                .max = range.max,
                                .meaning = meaning};
}

static void evaluate_time(const void *source, double time, double value[static 9])
{
    (void)source;
    value[0] = time;
}

struct frame_value timeline_value_time(void)
{
    return (struct frame_value){.type = FRAME_VALUE_FLOAT,
                                .evaluate = evaluate_time,
                                .min = value_range_any.min,
                                .max = value_range_any.max,
                                .meaning = "the frame's time"};
}

struct frame_value timeline_value_position(const struct timeline *timeline, const char *meaning)
{
    struct frame_value value = timeline_value(timeline, FRAME_VALUE_VEC3, value_range_any, meaning);

    value.is_position = true;
    return value;
}

bool timeline_value_is_zero(const struct timeline *timeline)
{
    double value[3] = {0};

    if (!timeline_is_constant(timeline)) return false;
    timeline_evaluate(timeline, 0, value);
    return value[0] == 0 && (timeline->component_count != 3 || (value[1] == 0 && value[2] == 0));
}

bool timeline_value_is_grey(const struct timeline *timeline)
{
    double value[3] = {0};

    if (timeline->component_count != 3) return true;
    if (!timeline_is_constant(timeline)) return false;
    timeline_evaluate(timeline, 0, value);
    return value[0] == value[1] && value[1] == value[2];
}
