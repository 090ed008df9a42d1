// Whole files: read with a limit, written so that a reader never meets half of one.
// SPDX-License-Identifier: Apache-2.0
// Messages leave out the path; callers prefix it.
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;

// `*text` is owned by the caller, ends in NUL (not counted in `*length`) and is NULL on failure. A file over
// `limit_bytes` is refused; the message has both sizes where the file's own is known. `length` may be NULL.
bool file_read_text(const char *path, size_t limit_bytes, char **text, size_t *length, struct error *error);

// Writes beside `path`, syncs, renames and syncs the folder; removes what it wrote on failure.
bool file_write_atomic(const char *path, const void *bytes, size_t size_bytes, struct error *error);

// Likewise, without the syncs: for what may be lost in a power cut.
bool file_replace(const char *path, const void *bytes, size_t size_bytes, struct error *error);

// Writes all of `size_bytes`, going on after EINTR and short counts.
bool file_write_all(int fd, const void *bytes, size_t size_bytes, struct error *error);
