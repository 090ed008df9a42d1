// What the audit of a frame has measured, in numbers and in the words of files and messages.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/frame_accuracy.h"

#include <stdbool.h>

// A picture whose values are all below it counts as black: its errors are absolute.
static const double AUDIT_BLACK = 1e-6;

enum audit_kind {
    AUDIT_NONE,        // the job states no tolerance
    AUDIT_REFERENCE,   // against the converged integral, in double precision
    AUDIT_STEP_HALVING // against the same shader in finer steps: code of the user's has no twin
};

struct audit_result {
    enum audit_kind kind;
    bool is_pooled; // measured over several frames of the segment
    double error;   // relative RMSE of the values as encoded; absolute where all light is below 1e-6
    double error95; // upper bound of `error`, with a confidence of 95 %
    double spread;  // a standard error of `error`, which is to be within the tolerance by as much; 0: not known
    double interpolation_error; // the part of `error` that interpolated pixels add; 0 where every pixel was traced
    int ray_count;              // pixels that were measured
    double tolerance;           // what the job allows
    bool is_missed;             // `error` is over it, and the job has such frames published
    double seconds;             // the time that the audit took
    // For a frame with rough surfaces, the standard error of its randomly sampled values, relative as `error` is.
    // `error` leaves out differences within four times that in a pixel.
    double sampling_error;
};

const char *audit_result_kind_name(enum audit_kind kind); // NULL for AUDIT_NONE
enum audit_kind audit_result_find_kind(const char *name); // AUDIT_NONE where no kind has that name

// The accuracy of a frame that `method` rendered, as messages state it; its cut rays are left out.
struct frame_accuracy audit_result_accuracy(const struct audit_result *audit, const char *method);
