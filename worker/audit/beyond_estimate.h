// Estimates how much light some orders of scattering leave out of a picture, from pixels with random paths.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

// A drawn pixel. D1 and D2 are two independent unbiased measurements of the light that is left out, A1 and A2 of all
// light, from the same paths as D1 and D2. All values are means over R, G and B.
struct beyond_sample {
    double product; // D1 D2: the square without the noise of either
    double square;  // ((D1 + D2) / 2)^2: the square with noise, which makes it larger in the mean
    double whole;   // A1 A2
};

struct beyond_verdict {
    double error;   // RMS of the light that is left out over the RMS of all light, [0, 1]; NAN: all is black
    double error95; // at least the true ratio, with a confidence of 95 %
    bool is_noisy;  // the ratio came out far above 1, which none is: so few paths say nothing
};

// The error is the root of the products' sum over the wholes' sum, a ratio estimate. error95 is the empirical Bernstein
// bound (Maurer and Pontil, COLT 2009) on what remains of each product without that ratio of its whole (Cochran,
// Sampling Techniques, 1977), the largest one seen standing for their range. Where few products are not 0 the squares
// are bounded too. It is never below 3 over the number of paths that saw light: what paths find more rarely, they may
// have missed (Hanley and Lippman-Hand, Journal of the American Medical Association 249, 1983). `paths` are those of
// each pixel. tests/worker/audit/beyond_estimate_test measures how often the bound holds.
struct beyond_verdict beyond_estimate(const struct beyond_sample *samples, size_t count, int paths);
