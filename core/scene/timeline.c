// SPDX-License-Identifier: Apache-2.0
#include "core/scene/timeline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The sine of one degree. Closer to the x axis, an orbit's axis leaves too short a projection of x to start from.
static const double AXIS_ALONG_X_SIN = 0.01745240643728351;

void timeline_finish(struct timeline *timeline)
{
    if (timeline->kind == TIMELINE_KEYS) free(timeline->keys.keys);
    *timeline = (struct timeline){0};
}

static void normalize(const double vector[3], double unit[3])
{
    double length = hypot(hypot(vector[0], vector[1]), vector[2]);

    for (int i = 0; i < 3; i++)
        unit[i] = vector[i] / length;
}

static void evaluate_orbit(const struct timeline *timeline, double time, double value[3])
{
    double angle = 2.0 * M_PI * fmod(time / timeline->orbit.period, 1.0) + timeline->orbit.phase_rad;
    double axis[3], start[3] = {0.0, 0.0, 0.0}, side[3];
    int towards;

    normalize(timeline->orbit.axis, axis);
    towards = hypot(axis[1], axis[2]) < AXIS_ALONG_X_SIN ? 1 : 0;
    start[towards] = 1.0;
    for (int i = 0; i < 3; i++)
        start[i] -= axis[towards] * axis[i];
    normalize(start, start);
    side[0] = axis[1] * start[2] - axis[2] * start[1];
    side[1] = axis[2] * start[0] - axis[0] * start[2];
    side[2] = axis[0] * start[1] - axis[1] * start[0];
    for (int i = 0; i < 3; i++)
        value[i] = timeline->orbit.center[i] + timeline->orbit.height * axis[i] +
                   timeline->orbit.radius * (cos(angle) * start[i] + sin(angle) * side[i]);
}

static void evaluate_keys(const struct timeline *timeline, double time, double value[3])
{
    const struct timeline_key *keys = timeline->keys.keys;
    size_t before = 0, after = timeline->keys.count; // keys[before].time <= time < keys[after].time, where they exist
    double share = 0.0;

    while (after - before > 1) {
        size_t middle = before + (after - before) / 2;

        if (keys[middle].time <= time)
            before = middle;
        else
            after = middle;
    }
    if (after < timeline->keys.count && time > keys[before].time)
        share = (time - keys[before].time) / (keys[after].time - keys[before].time);
    if (timeline->keys.interpolation == TIMELINE_INTERPOLATE_HOLD) share = 0.0;
    if (timeline->keys.interpolation == TIMELINE_INTERPOLATE_SMOOTH) share = share * share * (3.0 - 2.0 * share);
    for (int i = 0; i < timeline->component_count; i++) {
        double from = keys[before].value[i], to = share > 0.0 ? keys[after].value[i] : from;

        // Rounding could leave the interval between both by one digit, and so the allowed range.
        value[i] = fmax(fmin(from, to), fmin(fmax(from, to), (1.0 - share) * from + share * to));
    }
}

void timeline_evaluate(const struct timeline *timeline, double time, double value[static 3])
{
    switch (timeline->kind) {
    case TIMELINE_CONSTANT:
        for (int i = 0; i < timeline->component_count; i++)
            value[i] = timeline->value[i];
        break;
    case TIMELINE_LINEAR:
        for (int i = 0; i < timeline->component_count; i++)
            value[i] = timeline->linear.start[i] + timeline->linear.rate[i] * time;
        break;
    case TIMELINE_LISSAJOUS:
        for (int i = 0; i < timeline->component_count; i++)
            value[i] = timeline->lissajous.center[i] +
                       timeline->lissajous.amplitude[i] *
                           sin(timeline->lissajous.frequency_rad[i] * timeline->lissajous.speed * time +
                               timeline->lissajous.phase_rad[i]);
        break;
    case TIMELINE_KEYS:
        evaluate_keys(timeline, time, value);
        break;
    case TIMELINE_ORBIT:
        evaluate_orbit(timeline, time, value);
        break;
    }
}

static bool component_is_constant(const struct timeline *timeline, int i)
{
    switch (timeline->kind) {
    case TIMELINE_CONSTANT:
        return true;
    case TIMELINE_LINEAR:
        return timeline->linear.rate[i] == 0.0;
    case TIMELINE_LISSAJOUS:
        return timeline->lissajous.amplitude[i] == 0.0 ||
               timeline->lissajous.frequency_rad[i] * timeline->lissajous.speed == 0.0;
    case TIMELINE_KEYS:
        for (size_t k = 1; k < timeline->keys.count; k++)
            if (timeline->keys.keys[k].value[i] != timeline->keys.keys[0].value[i]) return false;
        return true;
    case TIMELINE_ORBIT:
        return timeline->orbit.radius == 0.0;
    }
    return false;
}

bool timeline_is_constant(const struct timeline *timeline)
{
    for (int i = 0; i < timeline->component_count; i++)
        if (!component_is_constant(timeline, i)) return false;
    return true;
}

static void find_key_bounds(const struct timeline *timeline, int i, double *min, double *max)
{
    *min = *max = timeline->keys.keys[0].value[i];
    for (size_t k = 1; k < timeline->keys.count; k++) {
        *min = fmin(*min, timeline->keys.keys[k].value[i]);
        *max = fmax(*max, timeline->keys.keys[k].value[i]);
    }
}

static void find_orbit_bounds(const struct timeline *timeline, double min[3], double max[3])
{
    double axis[3];

    normalize(timeline->orbit.axis, axis);
    for (int i = 0; i < 3; i++) {
        double middle = timeline->orbit.center[i] + timeline->orbit.height * axis[i];
        double extent = fabs(timeline->orbit.radius) * sqrt(fmax(1.0 - axis[i] * axis[i], 0.0));

        min[i] = middle - extent;
        max[i] = middle + extent;
    }
}

static void find_component_bounds(const struct timeline *timeline, struct timeline_span span, int i, double *min,
                                  double *max)
{
    double first[3], last[3], extent;

    switch (timeline->kind) {
    case TIMELINE_CONSTANT:
    case TIMELINE_LINEAR:
        timeline_evaluate(timeline, span.first, first);
        timeline_evaluate(timeline, span.last, last);
        *min = fmin(first[i], last[i]);
        *max = fmax(first[i], last[i]);
        break;
    case TIMELINE_LISSAJOUS:
        extent = fabs(timeline->lissajous.amplitude[i]);
        *min = timeline->lissajous.center[i] - extent;
        *max = timeline->lissajous.center[i] + extent;
        break;
    case TIMELINE_KEYS:
        find_key_bounds(timeline, i, min, max);
        break;
    case TIMELINE_ORBIT:
        break;
    }
}

void timeline_find_bounds(const struct timeline *timeline, struct timeline_span span, double min[static 3],
                          double max[static 3])
{
    if (timeline->kind == TIMELINE_ORBIT) {
        find_orbit_bounds(timeline, min, max);
        return;
    }
    for (int i = 0; i < timeline->component_count; i++)
        find_component_bounds(timeline, span, i, &min[i], &max[i]);
}

double timeline_find_largest(const struct timeline *timeline, struct timeline_span span)
{
    double min[3] = {0.0}, max[3] = {0.0};

    timeline_find_bounds(timeline, span, min, max);
    return max[0];
}
