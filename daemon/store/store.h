// What survives: jobs, frames and attempts in SQLite. Blocking; used from one thread at a time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/store/store_op.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct store;

// Opens or makes FOLDER/queue.db (folder made with mode 0700 if missing, its parent must exist) and locks it against a
// second daemon. A store of an older version becomes one of this version, with all that it holds. Refuses, and leaves as
// it is, a store a newer version wrote and a file that is no store. Adds one to the epoch, durably. NULL on failure.
struct store *store_open(const char *folder, struct error *error);
void store_close(struct store *store); // accepts NULL
int64_t store_epoch(const struct store *store);
int64_t store_next_job_id(const struct store *store); // one more than any the store holds

// All or nothing; on success it is on disk. On failure nothing of it is, the message names the cause ("disk full"), and
// the same ops may be committed again.
bool store_commit(struct store *store, const struct store_op *ops, size_t op_count, struct error *error);

// Called once a row; what they are given is lent for the call. False stops with the callback's error.
typedef bool store_on_job(void *user, const struct store_job *job, struct error *error);
typedef bool store_on_frame(void *user, const struct store_frame *frame, struct error *error);
// All jobs by id, then all frames by job and index. Of a frame with no publish intent only job, index, state, attempts
// and size_bytes are set: a restart needs no more, and a million rows are read in a second.
bool store_load(struct store *store, store_on_job *on_job, store_on_frame *on_frame, void *user, struct error *error);
