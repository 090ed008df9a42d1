// The programs that were installed together with this one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// A path in the folder of the running program, whether or not something is there. The caller frees it.
char *program_beside_find(const char *name);
// What the program prints to standard output when it gets one argument; NULL if it cannot be run or fails. The caller
// frees it.
char *program_beside_ask(const char *name, const char *argument);
