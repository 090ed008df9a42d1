// Clocks in seconds, for durations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

double clock_now_s(void);             // since some moment before the program started; it only goes forward
double clock_read_s(clockid_t clock); // any clock, such as CLOCK_PROCESS_CPUTIME_ID
