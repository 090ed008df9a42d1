// One daemon a state folder: the folder, and the lock that a second daemon meets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;

// Makes `folder` with mode 0700 if it is missing (its parent must exist) and locks it while the descriptor is open;
// -1 on failure.
int store_lock_take(const char *folder, struct error *error);
