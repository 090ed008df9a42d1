// Cuts a stream of bytes into lines of limited length.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;

// The longest line of the protocol, in bytes. A job document fits into one.
enum { MESSAGE_LINE_LIMIT = 4 * 1024 * 1024 };

// The zero value is an empty stream with limit MESSAGE_LINE_LIMIT.
struct message_stream {
    char *bytes; // owned
    size_t start;
    size_t end;
    size_t scanned; // no newline before this offset
    size_t capacity;
    size_t limit_bytes;
};

void message_stream_finish(struct message_stream *stream);

// Returns room to read into, at least one byte. Afterwards message_stream_commit says how many bytes were read.
char *message_stream_reserve(struct message_stream *stream, size_t *room);
void message_stream_commit(struct message_stream *stream, size_t size_bytes);
void message_stream_append(struct message_stream *stream, const char *bytes, size_t size_bytes);

// The next whole line without its newline (and a carriage return before it), valid until the next reserve, commit or
// append. Returns NULL with `error` empty when there is none yet, and NULL with `error` set when the line is over the
// limit; the stream is then unusable.
const char *message_stream_next(struct message_stream *stream, size_t *length, struct error *error);
