// Makes a worker that crashes for want of memory say so: some libraries crash when an allocation fails.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

// From this call on, a crash with more than a third of `limit_bytes` allocated ends the process with
// WORKER_STATUS_MEMORY. 0: there is no limit, and nothing is done.
void memory_end_watch(int64_t limit_bytes);
