// What a worker's exit status says to whoever started it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum worker_status {
    WORKER_STATUS_MEMORY = 12 // it died for want of the memory that it may allocate
};
