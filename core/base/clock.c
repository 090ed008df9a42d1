// SPDX-License-Identifier: Apache-2.0
#include "core/base/clock.h"

#include <time.h>

double clock_read_s(clockid_t clock)
{
    struct timespec now;

    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double clock_now_s(void)
{
    return clock_read_s(CLOCK_MONOTONIC);
}
