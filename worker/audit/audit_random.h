// Random numbers by which audits draw pixels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct job;

// The seed of a frame of that job.
uint64_t audit_random_seed(const struct job *job, int32_t frame);
// A random number in [0, 1). Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, OOPSLA 2014.
double audit_random(uint64_t *state);
// The index of the first of `count` running sums that is above `share` of the last one.
int audit_random_step(const double *sums, int count, double share);
