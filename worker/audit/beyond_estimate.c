// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/beyond_estimate.h"

#include <math.h>

static const double LOG_OF_20 = 2.995732273553991;
static const double NOISY = 1.1;        // a ratio
static const double UNSEEN = 3.0;       // the expected number of events of which none is seen in 5 % of all cases
static const double FEW_PRODUCTS = 100; // that are not 0

static double product_of(const struct beyond_sample *sample)
{
    return sample->product;
}

static double square_of(const struct beyond_sample *sample)
{
    return sample->square;
}

// An upper bound of the squared ratio.
static double bound(const struct beyond_sample *samples, size_t count,
                    double (*value_of)(const struct beyond_sample *sample))
{
    double sum = 0.0, whole = 0.0, squares = 0.0, largest = 0.0, ratio, deviation;

    if (count < 2) return INFINITY;
    for (size_t i = 0; i < count; i++) {
        sum += value_of(&samples[i]);
        whole += samples[i].whole;
    }
    ratio = sum / whole;
    for (size_t i = 0; i < count; i++) {
        double rest = value_of(&samples[i]) - ratio * samples[i].whole;

        squares += rest * rest;
        largest = fmax(largest, fabs(rest));
    }
    deviation = sqrt(squares / (double)(count - 1));
    return fmax(ratio, 0.0) + (deviation * sqrt(2.0 * LOG_OF_20 / (double)count) +
                               7.0 * LOG_OF_20 * largest / (3.0 * (double)(count - 1))) /
                                  (whole / (double)count);
}

struct beyond_verdict beyond_estimate(const struct beyond_sample *samples, size_t count, int paths)
{
    double product = 0.0, whole = 0.0, seen = 0.0, found = 0.0, most, least;

    for (size_t i = 0; i < count; i++) {
        product += samples[i].product;
        whole += samples[i].whole;
        seen += samples[i].whole != 0.0;
        found += samples[i].product != 0.0;
    }
    if (!(whole > 0.0)) return (struct beyond_verdict){.error = NAN, .error95 = NAN};
    most = bound(samples, count, product_of);
    if (found < FEW_PRODUCTS) most = fmax(most, bound(samples, count, square_of));
    least = UNSEEN / (seen * paths);
    return (struct beyond_verdict){.error = fmin(sqrt(fmax(product / whole, 0.0)), 1.0),
                                   .error95 = fmin(fmax(sqrt(most), least), 1.0),
                                   .is_noisy = product > NOISY * NOISY * whole};
}
