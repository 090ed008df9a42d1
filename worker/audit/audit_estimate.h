// Estimates a frame's error from measured pixels, with a confidence bound.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

// A drawn pixel that was measured. All values are means over R, G and B, divided by the pixel's density in the map and
// by the mean square of the frame's values (by 1 for a black frame).
struct audit_sample {
    double square; // (I - R)^2, I being the frame and R the reference, less the noise of both that is known
    double cross;  // I (I - R)
    double noise;  // variance of I by the random normals of rough surfaces
};

// A growing list. The zero value is empty.
struct audit_samples {
    struct audit_sample *list; // owned
    size_t count, capacity;
};

void audit_samples_append(struct audit_samples *samples, const struct audit_sample *sample);
void audit_samples_finish(struct audit_samples *samples); // leaves it empty

struct audit_evidence {
    const struct audit_samples *own; // of this frame
    // Samples of other frames of the segment with the same quality, small or whole; NULL: none.
    const struct audit_samples *pool;
    // `change` of the frame's own map (audit_map.h), and the largest of the pool's; negative: not known.
    double change, pool_change;
    double resolution; // the reference's own error: smaller errors cannot be measured
    bool is_random;    // squares have the noise of random paths: the largest of few may be above the pool's by chance
    bool is_black;     // the samples are absolute
};

struct audit_verdict {
    double error, error95; // relative to the RMS of the light; infinite where a value of the frame is not finite
    double spread;         // a standard error of `error`
    double sampling_error; // standard error of the frame by random normals, likewise relative
    size_t ray_count;      // samples from which the error was estimated
    bool is_pooled;        // by the pool's samples too; false where the frame is unlike the pool
};

// error95 is the largest of:
// - the empirical Bernstein bound on the mean of the squares (Maurer and Pontil, COLT 2009) with a confidence of 95 %,
//   the largest square seen standing for their range;
// - the change by halving the steps in the frame's own small renders;
// - the resolution.
// For a pooled frame the squares are the pool's and its own. They grow by the square of the frame's change over the
// pool's, if that is larger. A frame whose own squares are unlike the pool's is judged by them alone.
// tests/light/audit_coverage_test measures how often the bound holds.
struct audit_verdict audit_estimate(const struct audit_evidence *evidence);
// Adds an independent error to another one and its standard error: their squares add up.
void audit_estimate_join(const struct audit_verdict *verdict, double *error, double *spread);
