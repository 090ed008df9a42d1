// What measured pixels say of a frame's error, and how sure that is.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

// A drawn pixel that was measured. All values are means of R, G and B over the pixel's density in the map, relative to the
// mean square of the frame's values, or absolute where that is black.
struct audit_sample {
    double square; // (I - R)^2, as far as it stands out of what lots of rough surfaces leave
    double cross;  // I (I - R)
    double noise;  // variance of I by lot
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
    const struct audit_samples
        *pool; // of frames of the segment that were made in the same way, small or whole; NULL: none
    // Of the frame's own map, see worker/audit/audit_map.h, and the largest of the pool's; negative: not known.
    double change, pool_change;
    double resolution; // errors below it are not told from none: those of the reference
    bool is_black;     // the samples are absolute
};

struct audit_verdict {
    double error,
        error95; // relative to the light itself, not to the frame; not finite where a value of the frame is not
    double sampling_error; // of the frame by lot: the standard error, likewise relative
    size_t ray_count;      // of samples that the error comes from
    bool is_pooled;        // false too where there is a pool that the frame is not like
};

// error95 is the greatest of:
// - the empirical Bernstein bound on the mean of the squares (Maurer and Pontil, COLT 2009) with 95 %, for their range the
//   largest one seen;
// - what halving the steps changes in the frame's own small renders;
// - the resolution.
// Of a pooled frame the squares are those of the pool and its own, and they grow as much as halving changes more in this frame
// than in the pool. A frame whose own squares are unlike the pool's is judged by them alone.
struct audit_verdict audit_estimate(const struct audit_evidence *evidence);
