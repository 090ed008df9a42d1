// The exit statuses of a worker that have a meaning to its parent.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum worker_status {
    WORKER_STATUS_MEMORY = 12 // it reached its limit of memory
};
