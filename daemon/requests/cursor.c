// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/cursor.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DIGITS_LIMIT = 18 };

void cursor_format(char text[static CURSOR_TEXT_SIZE], enum cursor_list list, int64_t position)
{
    snprintf(text, CURSOR_TEXT_SIZE, "%c%" PRId64, (char)list, position);
}

bool cursor_parse(const char *text, enum cursor_list list, int64_t *position)
{
    size_t digits;

    if (text[0] != (char)list) return false;
    digits = strspn(text + 1, "0123456789");
    if (digits == 0 || digits > DIGITS_LIMIT || text[1 + digits]) return false;
    *position = strtoll(text + 1, NULL, 10);
    return true;
}
