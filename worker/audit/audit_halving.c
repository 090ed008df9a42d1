// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/audit.h"

#include "core/job/job.h"
#include "worker/picture/image.h"

#include <math.h>

// Errors at kinks, and by light that moves between steps, follow no order. Measured were errors of up to 2.6 times the
// change: tests/worker/audit/audit_halving_test.
static const double SAFETY = 2.25;

// The error that remains after halving the steps, relative to the change by it: 1 / (2^order - 1), by Richardson's
// extrapolation.
static double left_over_change(enum job_method method)
{
    switch (method) {
    case JOB_METHOD_RIEMANN:
        return 1.0;
    case JOB_METHOD_JITTERED:
    case JOB_METHOD_TRACKING:
    case JOB_METHOD_PATHS:
        return 0.0; // noise: the difference of two pictures is larger than the error of either
    case JOB_METHOD_MIDPOINT:
    case JOB_METHOD_EQUIANGULAR:
    case JOB_METHOD_ADAPTIVE:
    case JOB_METHOD_GAUSS:
    case JOB_METHOD_CACHED:
    case JOB_METHOD_PREINTEGRATED:
    case JOB_METHOD_AUTO:
    case JOB_METHOD_DRAFT:
        break;
    }
    // Second order or more; kinks of a density leave no more than that.
    return 1.0 / 3.0;
}

void audit_by_halving(const struct job *job, const struct image *coarser, const struct image *finer,
                      struct audit_result *result)
{
    size_t count = (size_t)finer->width_px * (size_t)finer->height_px;
    double squares = 0.0, square = 0.0, change;

    for (size_t i = 0; i < 4 * count; i++) {
        double difference = (double)coarser->rgba[i] - finer->rgba[i];

        if (i % 4 == 3) continue; // alpha
        squares += difference * difference;
        square += (double)finer->rgba[i] * finer->rgba[i];
    }
    change = square > 0.0 ? sqrt(squares / square) : sqrt(squares / (3.0 * (double)count));
    *result = (struct audit_result){.kind = AUDIT_STEP_HALVING,
                                    .error = change * (1.0 + left_over_change(job->quality.method)),
                                    .ray_count = (int)count,
                                    .tolerance = job->quality.tolerance};
    result->error95 = isfinite(change) ? SAFETY * result->error : INFINITY;
}
