// A number or a vector that may change with time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum timeline_kind {
    TIMELINE_CONSTANT,  // value
    TIMELINE_LINEAR,    // start + rate t
    TIMELINE_LISSAJOUS, // center + amplitude sin(frequency speed t + phase) per component
    TIMELINE_KEYS,      // interpolated between keys
    TIMELINE_ORBIT      // a circle; three components only
};

enum timeline_interpolation {
    TIMELINE_INTERPOLATE_LINEAR,
    TIMELINE_INTERPOLATE_SMOOTH, // smoothstep between keys, so that the rate is 0 at each key
    TIMELINE_INTERPOLATE_HOLD    // the last key at or before t
};

struct timeline_key {
    double time; // s, ascending
    double value[3];
};

// Times are in seconds, values in the unit of the driven value. The zero value is the constant 0.
struct timeline {
    enum timeline_kind kind;
    int component_count; // 1 or 3
    union {
        double value[3];
        struct {
            double start[3];
            double rate[3]; // per second
        } linear;
        struct {
            double center[3], amplitude[3];
            double frequency_rad[3]; // rad/s
            double phase_rad[3];
            double speed;
        } lissajous;
        struct {
            struct timeline_key *keys; // owned
            size_t count;
            enum timeline_interpolation interpolation;
        } keys;
        struct {
            double center[3], axis[3]; // axis: any length but 0
            double radius, height;     // m; height along the axis
            double period;             // s, not 0
            double
                phase_rad; // from the projection of the world's x onto the orbit's plane; of y when the axis is along x
        } orbit;
    };
};

// An interval of time, s.
struct timeline_span {
    double first, last;
};

typedef void timeline_visitor(const char *name, struct timeline *timeline, void *user);

void timeline_finish(struct timeline *timeline);
// Before the first key and after the last, the value is theirs. Only the first component_count elements are written. An
// orbit runs counter-clockwise seen from the axis' tip; with a negative period, clockwise.
void timeline_evaluate(const struct timeline *timeline, double time, double value[static 3]);
// True when the value is the same at all times.
bool timeline_is_constant(const struct timeline *timeline);
// Bounds of each component within `span`. They are exact for constant and linear timelines; for others they hold at all
// times.
void timeline_find_bounds(const struct timeline *timeline, struct timeline_span span, double min[static 3],
                          double max[static 3]);
// The largest value of a number within `span`, bounded as above.
double timeline_find_largest(const struct timeline *timeline, struct timeline_span span);
