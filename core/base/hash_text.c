// SPDX-License-Identifier: Apache-2.0
#include "core/base/hash_text.h"

#include <string.h>

void hash_text_numbers(FILE *text, const char *key, const double *numbers, int count)
{
    fprintf(text, " %s", key);
    for (int i = 0; i < count; i++)
        fprintf(text, " %.17g", numbers[i] + 0.0); // turns -0 into 0
}

void hash_text_string(FILE *text, const char *key, const char *value)
{
    fprintf(text, " %s %zu %s", key, value ? strlen(value) : 0, value ? value : "");
}
