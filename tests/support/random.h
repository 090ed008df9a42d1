// A generator of random numbers, the same in every run of a test.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

// Seeded with any value but 0.
struct random {
    uint64_t state;
};

// Uniform in [low, high). Marsaglia, Xorshift RNGs, Journal of Statistical Software 8, 2003, with Vigna's multiplier.
double random_between(struct random *random, double low, double high);
