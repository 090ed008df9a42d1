// Writes values as text that is hashed: different values are different texts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

// " KEY NUMBER..." with all digits; -0 is written as 0.
void hash_text_numbers(FILE *text, const char *key, const double *numbers, int count);
// " KEY LENGTH VALUE": the length keeps a value apart from what follows. NULL is written as an empty one.
void hash_text_string(FILE *text, const char *key, const char *value);
