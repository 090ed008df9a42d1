// Marks of frames that have no row of their own, two bits each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/store/store_op.h"

struct error;
struct queue_job;
struct sqlite3;
struct sqlite3_stmt;

// The op that stores the marks of all frames of the job as they are now: STORE_SET_MARKS.
struct store_op store_marks_format_op(const struct queue_job *job);

// Texts of the statements that store_marks_set runs.
extern const char store_marks_set_sql[], store_marks_drop_sql[];

// Writes the blocks that change; a block without a mark has no row.
bool store_marks_set(struct sqlite3_stmt *set, struct sqlite3_stmt *drop, const struct store_op *op,
                     struct error *error);
// Calls `on_frame` for each marked frame, with job, index and state set.
bool store_marks_load(struct sqlite3 *db, store_on_frame *on_frame, void *user, struct error *error);
