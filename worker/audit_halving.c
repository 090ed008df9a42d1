#include "worker/audit.h"

#include "core/job.h"
#include "worker/image.h"

#include <math.h>

// What halving leaves of the error, at worst: half, as of a method of first order, which the kinks of a density make of any.
static const double LEFT = 0.5;
static const double SAFETY = 1.5;

void audit_by_halving(const struct job *job, const struct image *coarser, const struct image *finer,
                      struct audit_result *result)
{
    double difference = 0.0, square = 0.0, change;

    for (size_t i = 0; i < 4 * (size_t)finer->width_px * (size_t)finer->height_px; i++) {
        double apart = (double)coarser->rgba[i] - finer->rgba[i];

        if (i % 4 == 3) continue;
        difference += apart * apart;
        square += (double)finer->rgba[i] * finer->rgba[i];
    }
    change = square > 0.0 ? sqrt(difference / square) : 0.0;
    *result = (struct audit_result){.kind = AUDIT_STEP_HALVING,
                                    .error = change,
                                    .error95 = SAFETY * change / (1.0 - LEFT),
                                    .tolerance = job->quality.tolerance};
}
