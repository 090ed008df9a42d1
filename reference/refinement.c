// SPDX-License-Identifier: Apache-2.0
#include "reference/refinement.h"

#include <math.h>

// Of the square of the allowed error, what the cells may have that are not refined.
static const double KEPT_SHARE = 0.7;
// The factor by which a halving divides an error at least, even at a kink: 2^2.
static const double LEAST_GAIN = 4.0;

static double error_at(const struct refinement *cells, size_t index)
{
    return *(const double *)((const char *)cells->errors + index * cells->stride_bytes);
}

// Of the cells whose errors are not above the limit.
static double sum_squares(const struct refinement *cells, double limit)
{
    double sum = 0.0;

    for (size_t i = 0; i < cells->count; i++) {
        double error = error_at(cells, i);

        if (error <= limit) sum += error * error;
    }
    return sum;
}

double refinement_error(const struct refinement *cells)
{
    return sqrt(sum_squares(cells, INFINITY));
}

double refinement_limit(const struct refinement *cells, double allowed)
{
    double limit = 0.0;

    for (size_t i = 0; i < cells->count; i++) {
        double error = error_at(cells, i);

        if (isfinite(error)) limit = fmax(limit, error);
    }
    while (sum_squares(cells, limit) > KEPT_SHARE * allowed * allowed)
        limit *= 0.5;
    return limit;
}

void refinement_doubt(double *first, double *second, double change)
{
    *first = fmax(*first, fabs(change) / LEAST_GAIN);
    *second = fmax(*second, fabs(change) / LEAST_GAIN);
}
