// SPDX-License-Identifier: Apache-2.0
#include "core/base/nearest_name.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

static size_t min3(size_t a, size_t b, size_t c)
{
    size_t ab = a < b ? a : b;

    return ab < c ? ab : c;
}

enum { NAME_LIMIT = 48 };

// The least number of insertions, deletions, substitutions and swaps of neighbours from `a` to `b`, ignoring case. Both
// have at most NAME_LIMIT bytes.
static size_t edit_distance(const char *a, const char *b)
{
    size_t rows[3][NAME_LIMIT + 1];
    size_t a_length = strlen(a), b_length = strlen(b);
    size_t *before = rows[0], *previous = rows[1], *current = rows[2];

    for (size_t j = 0; j <= b_length; j++)
        previous[j] = j;
    for (size_t i = 1; i <= a_length; i++) {
        size_t *recycled = before;

        current[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            bool differs = tolower((unsigned char)a[i - 1]) != tolower((unsigned char)b[j - 1]);
            bool is_swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];

            current[j] = min3(previous[j] + 1, current[j - 1] + 1, previous[j - 1] + differs);
            if (is_swap && before[j - 2] + 1 < current[j]) current[j] = before[j - 2] + 1;
        }
        before = previous;
        previous = current;
        current = recycled;
    }
    return previous[b_length];
}

const char *nearest_name_find(const char *text, const char *const names[])
{
    const char *nearest = NULL;
    size_t length = strlen(text);
    size_t limit = length < 4 ? 1 : 1 + length / 3;

    if (length == 0 || length > NAME_LIMIT) return NULL;
    for (size_t i = 0; names[i]; i++) {
        size_t distance;

        if (strlen(names[i]) > NAME_LIMIT) continue;
        distance = edit_distance(text, names[i]);
        if (distance <= limit && distance < strlen(names[i])) {
            nearest = names[i];
            limit = distance - (distance > 0);
            if (distance == 0) break;
        }
    }
    return nearest;
}
