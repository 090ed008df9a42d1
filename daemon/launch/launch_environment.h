// The environment of a launcher: what it needs to find its way and its keys.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Borrows the variables from our own environment; the array, which ends in NULL, is the caller's to free.
char **launch_environment_make(void);
