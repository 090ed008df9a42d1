// Reads the bytes of a volume file in order, without holding all of them. Messages do not name the path.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct volume_stream;

// Opens regular files only, so that reading cannot block. `*stream` is NULL on failure.
bool volume_stream_open(struct volume_stream **stream, const char *path, struct error *error);
void volume_stream_close(struct volume_stream *stream); // accepts NULL

const char *volume_stream_path(const struct volume_stream *stream);
int64_t
volume_stream_left(const struct volume_stream *stream); // bytes from the position to the file's end; -1: compressed
// Decompresses all that follows as gzip.
void volume_stream_unzip(struct volume_stream *stream);
// Skips bytes, counted after decompression.
bool volume_stream_skip(struct volume_stream *stream, int64_t size_bytes, struct error *error);

// Reads exactly `size_bytes`. A file that ends before is an error.
bool volume_stream_read(struct volume_stream *stream, void *bytes, size_t size_bytes, struct error *error);
bool volume_stream_read_byte(struct volume_stream *stream, int *byte, struct error *error); // -1 at the end
// Checks that nothing follows and that the file did not change since it was opened.
bool volume_stream_check_end(struct volume_stream *stream, struct error *error);
