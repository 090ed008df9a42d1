// The programs that were installed together with this one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

// A path in the folder of the running program, whether or not something is there. The caller frees it.
char *program_beside_find(const char *name);
// Runs the program with these arguments, NULL after the last, and waits; `is_quiet` drops its standard output. Its exit
// status; -1 if it cannot be run.
int program_beside_run(const char *name, const char *const arguments[], bool is_quiet);
// What the program prints to standard output when it gets one argument; NULL if it cannot be run or fails. The caller
// frees it.
char *program_beside_ask(const char *name, const char *argument);
