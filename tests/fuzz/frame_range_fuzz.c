// A range that parses is consistent with itself and survives being written and read again.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_range.h"

#include "core/base/alloc.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void require(bool condition)
{
    if (!condition) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    char *text = xstrndup((const char *)bytes, size);
    struct frame_range range, again;

    if (frame_range_parse(&range, text, NULL)) {
        int64_t count = frame_range_count(&range);
        // A prime step visits a sample of every long range at little cost.
        int64_t step = count < 5000 ? 1 : 997;
        char *formatted = frame_range_format(&range);

        require(count > 0 && count <= FRAME_COUNT_LIMIT);
        require(frame_range_parse(&again, formatted, NULL));
        require(frame_range_count(&again) == count);
        for (int64_t i = 0; i < count; i += step) {
            int32_t frame = frame_range_at(&range, i);

            require(frame >= 0 && frame < FRAME_NUMBER_LIMIT);
            require(frame_range_index(&range, frame) == i);
            require(frame_range_at(&again, i) == frame);
            require(frame_range_index(&again, frame) == i);
        }
        require(frame_range_index(&range, -1) == -1);
        free(formatted);
        frame_range_finish(&again);
    } else {
        require(frame_range_count(&range) == 0 && !range.spans);
    }
    frame_range_finish(&range);
    free(text);
    return 0;
}
