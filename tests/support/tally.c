// SPDX-License-Identifier: Apache-2.0
#include "tests/support/tally.h"

#include <math.h>

void tally_add(struct tally *tally, double value)
{
    double off = value - tally->mean;

    tally->mean += off / ++tally->count;
    tally->squares += off * (value - tally->mean);
}

double tally_find_error(const struct tally *tally)
{
    return sqrt(tally->squares / (tally->count * (tally->count - 1.0)));
}
