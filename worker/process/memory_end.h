// Has a worker that dies for want of memory say so: libraries that are refused some just crash.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

// From here on a crash with a good part of `limit_bytes` allocated ends the process with WORKER_STATUS_MEMORY. 0: no limit,
// and nothing is done.
void memory_end_watch(int64_t limit_bytes);
