// SPDX-License-Identifier: Apache-2.0
#include "tests/support/random.h"

double random_between(struct random *random, double low, double high)
{
    random->state ^= random->state >> 12;
    random->state ^= random->state << 25;
    random->state ^= random->state >> 27;
    return low + (high - low) * (double)((random->state * 0x2545F4914F6CDD1Du) >> 11) * 0x1p-53;
}
