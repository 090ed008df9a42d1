// How many observations fell into each of a few classes, and their sum. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { HISTOGRAM_END_LIMIT = 20 };

// The upper ends of classes, ascending; what is above the last one has a class of its own.
struct histogram_scale {
    double ends[HISTOGRAM_END_LIMIT];
    size_t count;
};

extern const struct histogram_scale histogram_work_s;    // s of a frame or a plan: 10 ms to two hours
extern const struct histogram_scale histogram_latency_s; // s until something is on disk: 0.5 ms to half a minute
extern const struct histogram_scale histogram_wait_s;    // s in a queue: a tenth to a week
extern const struct histogram_scale histogram_ratio;     // of what is allowed: a hundredth to ten times

// The zero value has seen nothing. The same scale belongs to all observations of one.
struct histogram {
    uint64_t counts[HISTOGRAM_END_LIMIT + 1]; // of each class
    double sum;
};

// A value comes from a clock or a worker, and must not spoil the sum: one that is negative or no number counts as 0,
// one over 1e9 as that.
void histogram_add(struct histogram *histogram, const struct histogram_scale *scale, double value);
