// SPDX-License-Identifier: Apache-2.0
#include "core/wire/message_stream.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { ROOM_MIN = 4096, CAPACITY_KEPT = 64 * 1024 };

static size_t line_limit(const struct message_stream *stream)
{
    return stream->limit_bytes > 0 ? stream->limit_bytes : MESSAGE_LINE_LIMIT;
}

void message_stream_finish(struct message_stream *stream)
{
    free(stream->bytes);
    *stream = (struct message_stream){.limit_bytes = stream->limit_bytes};
}

// Bytes are moved only when at least as many before them were consumed; else the memory doubles. A byte is therefore
// copied a bounded number of times, whatever the sizes of the reads.
static void make_room(struct message_stream *stream, size_t wanted)
{
    if (stream->start == stream->end) {
        stream->start = stream->end = stream->scanned = 0;
        if (stream->capacity > CAPACITY_KEPT && wanted <= CAPACITY_KEPT) {
            free(stream->bytes);
            stream->bytes = NULL;
            stream->capacity = 0;
        }
    }
    if (stream->capacity - stream->end >= wanted) return;
    if (stream->start > 0 && stream->start >= stream->end - stream->start) {
        memmove(stream->bytes, stream->bytes + stream->start, stream->end - stream->start);
        stream->end -= stream->start;
        stream->scanned -= stream->start;
        stream->start = 0;
    }
    if (stream->capacity - stream->end >= wanted) return;
    stream->bytes = xgrow(stream->bytes, &stream->capacity, stream->end + wanted, 1);
}

char *message_stream_reserve(struct message_stream *stream, size_t *room)
{
    make_room(stream, ROOM_MIN);
    *room = stream->capacity - stream->end;
    return stream->bytes + stream->end;
}

void message_stream_commit(struct message_stream *stream, size_t size_bytes)
{
    assert(size_bytes <= stream->capacity - stream->end);
    stream->end += size_bytes;
}

void message_stream_append(struct message_stream *stream, const char *bytes, size_t size_bytes)
{
    if (size_bytes == 0) return;
    make_room(stream, size_bytes);
    memcpy(stream->bytes + stream->end, bytes, size_bytes);
    stream->end += size_bytes;
}

const char *message_stream_next(struct message_stream *stream, size_t *length, struct error *error)
{
    size_t limit = line_limit(stream);
    size_t pending = stream->end - stream->start;
    const char *line, *newline;
    size_t size = pending;

    *length = 0;
    if (error) error->message[0] = '\0';
    if (pending == 0) return NULL;
    line = stream->bytes + stream->start;
    newline = memchr(stream->bytes + stream->scanned, '\n', stream->end - stream->scanned);
    if (newline) size = (size_t)(newline - line);
    stream->scanned = stream->start + size;
    if (size > 0 && line[size - 1] == '\r') size--;
    if (size > limit) {
        error_set(error, "a line is longer than %zu bytes", limit);
        return NULL;
    }
    if (!newline) return NULL;
    *length = size;
    stream->start = stream->scanned = (size_t)(newline - stream->bytes) + 1;
    return line;
}
