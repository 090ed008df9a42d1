// How far a frame is from the light it should show: measured on some of its pixels against reference/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/audit/audit_estimate.h"
#include "worker/picture/audit_result.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct image;
struct job;
struct truth;

enum {
    AUDIT_RAYS_MIN = 64,  // of a frame that is audited by itself
    AUDIT_RAYS_POOLED = 8 // of one that has a pool
};

// Of the time that the frame took to render: the budget of its audit. Set by hand.
static const double AUDIT_TIME_SHARE = 0.05;

// What a segment's frames share. The zero value is empty.
struct audit_pool {
    struct audit_samples samples;
    double change; // audit_map's, the largest of its frames'; 0: none was known
};

void audit_pool_finish(struct audit_pool *pool);

struct audit_params {
    const struct job *job; // as the frame was rendered: of its size, with the plan's quality
    int32_t frame;
    const struct image *image;
    // Small renders with the frame's own quality (`coarser`) and in steps half as long (`finer`), see worker/audit/audit_map.h; NULL:
    // there are none. `is_own`: of this frame, else of one near it.
    const struct image *finer, *coarser;
    bool is_own;
    const struct truth *truth;     // of the same job and frame
    const struct audit_pool *pool; // NULL: the frame is audited by itself
    struct audit_pool *gathered;   // NULL, or where this frame's samples are added
    double tolerance;
    double budget_s;                 // it stops when this is over, but not before the least number of pixels
    int ray_min, ray_max;            // 0: as the enumerators say, and 16 times as many
    int thread_count;                // 0: a thread for each core
    bool (*on_progress)(void *user); // NULL: none; false stops it
    void *user;
};

// Measures pixels against the reference until the budget is spent or it is plain on which side of the tolerance the frame is. A
// frame with a pool begins with AUDIT_RAYS_POOLED pixels and, when these show it to be unlike the pool, goes on by itself.
// False when on_progress stopped it.
bool audit_frame(const struct audit_params *params, struct audit_result *result);

// A frame by step halving: `coarser` in its own steps, `finer` in halved ones, of one size, the frame's or a smaller one. `job` is
// as it was rendered: Richardson's extrapolation goes by its method's order. error95 is 2.25 times that: no proof, what held on
// code of the user's that has a twin.
void audit_by_halving(const struct job *job, const struct image *coarser, const struct image *finer,
                      struct audit_result *result);
