// Mean of a random number and what chance leaves of it, summed without losing digits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The zero value has no numbers yet.
struct tally {
    double count, mean, squares; // `squares`: of what the numbers are off their mean, summed
};

void tally_add(struct tally *tally, double value);
double tally_find_error(const struct tally *tally); // the mean's standard error; takes two numbers at least
