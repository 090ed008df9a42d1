// The durable store: jobs, frames, attempts and plans in SQLite. Blocking; for one thread at a time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/store/store_load.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct store;

// Opens or makes FOLDER/queue.db and locks it against a second daemon. A missing folder is made with mode 0700; its
// parent must exist. A store of an older version is upgraded and keeps all that it holds. A store of a newer version,
// or a file that is no store, is refused and stays unchanged. The epoch grows by one, on disk. NULL on failure;
// `*is_full` (may be NULL) says whether it is for want of room on the disk.
struct store *store_open(const char *folder, bool *is_full, struct error *error);
void store_close(struct store *store); // accepts NULL
int64_t store_epoch(const struct store *store);
int64_t store_next_job_id(const struct store *store); // greater than any id that was ever used

int64_t store_next_plan_number(const struct store *store); // greater than that of any plan

// Commits all ops, or none on failure. On success they are on disk. On failure the message names the cause ("disk
// full"), and the same ops may be committed again. On a full disk the reserve is given up, and they are tried again.
bool store_commit(struct store *store, const struct store_op *ops, size_t op_count, struct error *error);
// Whether the store can take new work: its reserve is there or is made again, and a change of no meaning is committed.
bool store_probe(struct store *store, struct error *error);
bool store_is_full(const struct store *store);     // the latest failure was a full disk
bool store_has_reserve(const struct store *store); // false: the disk was full, and the reserve was given up

// Reads all jobs by id, then marked frames, then frames that have rows, by job and index: the last state of a frame
// holds. A marked frame has only job, index and state set; FRAME_QUEUED says that it is forced. A row without a publish
// intent has only job, index, state, attempts, size_bytes, render_s and audit_s set: a restart needs no more, and a
// million rows are read in a second.
bool store_load(struct store *store, store_on_job *on_job, store_on_frame *on_frame, void *user, struct error *error);
