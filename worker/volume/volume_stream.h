// The bytes of a volume file in order: read ahead a little, never held as a whole. Messages do not name the path.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct volume_stream;

// Regular files only: what is no file, or blocks, is refused. `*stream` is NULL on failure.
bool volume_stream_open(struct volume_stream **stream, const char *path, struct error *error);
void volume_stream_close(struct volume_stream *stream); // accepts NULL

const char *volume_stream_path(const struct volume_stream *stream);
int64_t volume_stream_left(const struct volume_stream *stream); // bytes of the file behind the position; -1: compressed
// What follows is gzip and comes out decompressed.
void volume_stream_unzip(struct volume_stream *stream);
// Skips bytes, of what is decompressed if it is.
bool volume_stream_skip(struct volume_stream *stream, int64_t size_bytes, struct error *error);

// Exactly `size_bytes`; a file that ends before is an error.
bool volume_stream_read(struct volume_stream *stream, void *bytes, size_t size_bytes, struct error *error);
bool volume_stream_read_byte(struct volume_stream *stream, int *byte, struct error *error); // -1 at the end
// Nothing may follow, and the file must still be the one that was opened.
bool volume_stream_check_end(struct volume_stream *stream, struct error *error);
