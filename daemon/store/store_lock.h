// The lock of the state folder, which holds off a second daemon.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;

enum { STORE_LOCK_WAIT_MS = 10 * 1000 };

// Makes `folder` with mode 0700 if it is missing (its parent must exist). Locks it for as long as the returned
// descriptor is open; -1 on failure, with the process that holds the lock named. Waits up to `wait_ms` for a lock whose
// daemon is dead.
int store_lock_take(const char *folder, int wait_ms, struct error *error);
