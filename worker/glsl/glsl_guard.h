// Rewrites code so that its first statements give 0 for values that are not finite.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

// The fewest statements with which a picture becomes finite tell the line where the first such value arises. Statements
// are returns and assignments within functions, in the order of the text. Each stays in its line.
struct glsl_guarded {
    char *text; // owned; NULL: there is no memory
    int count;  // statements that can be guarded
    int line;   // of the last statement that is; 0: there is none
};

// Guards the first `wanted` statements: of all kinds, or returns alone. Values of types other than numbers and vectors
// make guarded assignments fail to compile.
struct glsl_guarded glsl_guard(const char *source, int wanted, bool is_returns_only);
