// When a job is done beside the jobs of other owners, who have their shares of the workers. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct turns_owner;

// Another owner of jobs of the same priority.
struct eta_rival {
    const struct turns_owner *owner; // borrowed
    double seconds;                  // that their jobs take all workers; infinite: unknown
};

struct eta_params {
    double front_s;                  // that jobs of higher priorities take, which come first
    double own_s;                    // that the job and those of its owner before it take all workers
    const struct turns_owner *owner; // of the job; borrowed
    const struct eta_rival *rivals;  // borrowed; no owner twice
    size_t rival_count;
    int workers;        // at least 1
    double half_life_s; // as in struct turns_rules
};

// Seconds until the job is done. Until then each rival gets their share, or less where they need less. Before that,
// whoever used less for their weight catches up.
double eta_find_s(const struct eta_params *params);
