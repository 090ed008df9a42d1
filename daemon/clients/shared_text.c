// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/shared_text.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"

#include <stdlib.h>

// A text that is waited for lies in memory no longer than it is.
enum { SPARE_BYTES = 256 };

struct shared_text *shared_text_create(struct json_writer *writer)
{
    struct shared_text *text = xmalloc(sizeof *text);

    if (writer->capacity - writer->length > SPARE_BYTES) writer->text = xrealloc(writer->text, writer->length + 1);
    *text = (struct shared_text){.bytes = writer->text, .length = writer->length, .holders = 1};
    *writer = (struct json_writer){0};
    return text;
}

struct shared_text *shared_text_hold(struct shared_text *text)
{
    text->holders++;
    return text;
}

void shared_text_release(struct shared_text *text)
{
    if (!text || --text->holders > 0) return;
    free(text->bytes);
    free(text);
}
