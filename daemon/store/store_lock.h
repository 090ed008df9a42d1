// The lock of the state folder, which holds off a second daemon.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;

// Makes `folder` with mode 0700 if it is missing (its parent must exist). Locks it for as long as the returned
// descriptor is open; -1 on failure. Waits up to 10 s for a lock whose process is dead.
int store_lock_take(const char *folder, struct error *error);
