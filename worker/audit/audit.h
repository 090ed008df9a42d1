// Measures the error of a frame: some of its pixels against reference/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/integrate.h"
#include "worker/audit/audit_estimate.h"
#include "worker/picture/audit_result.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct image;
struct job;
struct pixel;
struct truth;

enum {
    AUDIT_RAYS_MIN = 64,    // pixels at least of a frame that is audited alone; docs/rendering.md has the measurement
    AUDIT_RAYS_POOLED = 16, // pixels at least of a frame that has a pool,
    AUDIT_RAYS_POOLED_RANDOM = 32 // where the light is random: few of noisy squares say little of what is broken
};

// The samples that the frames of a segment share. The zero value is empty.
struct audit_pool {
    struct audit_samples samples;
    double change; // the largest `change` of its frames' maps; 0: none was known
};

void audit_pool_finish(struct audit_pool *pool);

struct audit_params {
    const struct job *job; // as the frame was rendered: its size, with the plan's quality
    int32_t frame;
    const struct image *image;
    // Small renders with the frame's own quality (`coarser`) and in steps half as long (`finer`), as in audit_map.h.
    // NULL: none. `is_own`: they show this frame, else one near it.
    const struct image *finer, *coarser;
    bool is_own;
    const struct truth *truth;     // of the same job and frame
    const struct audit_pool *pool; // NULL: the frame is audited alone
    struct audit_pool *gathered;   // NULL, or the pool to which this frame's samples are added
    double tolerance;
    int ray_min, ray_max; // pixels at least and at most; 0: AUDIT_RAYS_MIN, and 16 times ray_min
    // A finer picture takes this one's place where it is not clearly within: that costs less than being sure. At most 4
    // times ray_min are measured, and an error over the tolerance by twice ray_min is believed.
    bool is_replaceable;
    int thread_count; // 0: a thread for each core
    // NULL, or traces pixels of a frame that has some interpolated, 4 floats each: their error alone is then found, and
    // what interpolation adds is not. False stops the audit.
    bool (*on_trace)(void *user, const struct pixel *points, size_t count, float *rgba);
    // What interpolation adds, or all 0: there are enough pixels when both together are clear.
    struct audit_verdict interpolation;
    // NULL: none; `done` grows with the number of pixels, towards 1; false stops it
    bool (*on_progress)(void *user, double done);
    void *user;
};

// What audits of a frame with this mean square ask of the reference.
struct integrate_accuracy audit_accuracy(double tolerance, double mean_square);
// Measures pixels against the reference until the error is a standard error from the tolerance, or there are enough.
// Their number follows from their values, never from a clock. A frame with a pool begins with few pixels.
// If these differ from the pool, it goes on alone. False when on_progress or on_trace stopped it.
bool audit_frame(const struct audit_params *params, struct audit_result *result);

// Measures a frame by step halving: `coarser` has some of its pixels, `finer` the same pixels in halved steps. `job` is
// the job as rendered; its method's order gives the error by Richardson's extrapolation. error95 is 2.25 times that.
// This is no proof, but held for the user's code of which there is a twin: tests/worker/audit/audit_halving_test.
void audit_by_halving(const struct job *job, const struct image *coarser, const struct image *finer,
                      struct audit_result *result);
