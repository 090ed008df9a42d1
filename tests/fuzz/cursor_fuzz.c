// A cursor that is read is not negative, and is written as it was but for leading zeros.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/cursor.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void require(bool condition)
{
    if (!condition) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static const enum cursor_list lists[] = {CURSOR_JOBS_UP, CURSOR_JOBS_DOWN, CURSOR_FRAMES};
    char *text = xstrndup((const char *)bytes, size);
    int read = 0;

    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        char written[CURSOR_TEXT_SIZE];
        int64_t position = -1, again = -1;

        if (!cursor_parse(text, lists[i], &position)) continue;
        require(position >= 0 && text[0] == (char)lists[i]);
        cursor_format(written, lists[i], position);
        require(strlen(written) <= strlen(text));
        require(cursor_parse(written, lists[i], &again) && again == position);
        read++;
    }
    require(read <= 1);
    free(text);
    return 0;
}
