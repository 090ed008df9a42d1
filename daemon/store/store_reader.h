// Answers from the store that the queue does not keep: rows of frames, attempts and job files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/store/store.h"

struct store_reader;

// A connection of its own that only reads: from any thread, one at a time, while the store is open elsewhere. Blocking.
struct store_reader *store_reader_open(const char *folder, struct error *error); // NULL on failure
void store_reader_close(struct store_reader *reader);                            // accepts NULL

// Rows for the frames with index in [first, last], ascending and complete; those without a row are not called.
bool store_read_frames(struct store_reader *reader, int64_t job, int32_t first, int32_t last, store_on_frame *on_frame,
                       void *user, struct error *error);
// The bytes of the files of those frames that were published, or were about to be.
bool store_read_bytes(struct store_reader *reader, int64_t job, int32_t first, int32_t last, int64_t *bytes,
                      struct error *error);
typedef bool store_on_attempt(void *user, const struct store_attempt *attempt, struct error *error);
// Newest first; frame -1: all.
bool store_read_attempts(struct store_reader *reader, int64_t job, int32_t frame, int limit,
                         store_on_attempt *on_attempt, void *user, struct error *error);
// `*document` is the job file as text, owned by the caller; NULL on failure. A job the store lacks is an error.
bool store_read_document(struct store_reader *reader, int64_t job, char **document, struct error *error);
