// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/audit_random.h"

#include "core/job/job.h"

uint64_t audit_random_seed(const struct job *job, int32_t frame)
{
    uint64_t seed = 0xcbf29ce484222325u ^ (uint32_t)frame;

    for (const char *at = job->hash; *at; at++)
        seed = (seed ^ (unsigned char)*at) * 0x100000001b3u;
    return seed;
}

double audit_random(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;

    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

int audit_random_step(const double *sums, int count, double share)
{
    double wanted = share * sums[count - 1];
    int low = 0, high = count - 1;

    while (low < high) {
        int middle = low + (high - low) / 2;

        if (sums[middle] > wanted)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}
