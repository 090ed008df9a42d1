// The store's tables, their version, and the reading of a frame's row.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct frame_accuracy;
struct sqlite3;
struct sqlite3_stmt;
struct store_frame;

#define STORE_SCHEMA_VERSION 13 // a macro because SQL text holds it
enum {
    STORE_SCHEMA_FIRST_WITH_SUMS = 9,
    STORE_SCHEMA_FIRST_WITH_TOKENS = 11,
    STORE_SCHEMA_FIRST_WITH_NOTICES = 12,
    STORE_SCHEMA_FIRST_WITH_WAITS = 13
};

// Whether this version can use the database; `*found` is the version that wrote it (0: it is empty). Changes nothing.
bool store_schema_check(struct sqlite3 *db, int *found, struct error *error);
// Makes the tables, or upgrades those of version `found`. To be called inside a transaction, on a
// connection that knows row_sum (store_sum.h).
bool store_schema_upgrade(struct sqlite3 *db, int found, struct error *error);

// The order that store_schema_read_frame expects.
#define STORE_SCHEMA_FRAME_COLUMNS                                                                                     \
    "job, frame_index, state, attempts, epoch, inode, size_bytes, hash, render_s, encode_s, error, audit, "            \
    "measured_error, error95, audit_rays, method, cut_share, plan, traced, audit_s"

// The columns of the other tables, in the order of their sums (store_sum.h). New columns come last.
#define STORE_SCHEMA_DAEMON_COLUMNS "epoch, last_job_id, farm"
#define STORE_SCHEMA_JOB_COLUMNS STORE_SCHEMA_JOB_FIRST_COLUMNS ", waits"
#define STORE_SCHEMA_JOB_FIRST_COLUMNS                                                                                 \
    "id, priority, is_paused, is_canceled, is_failed, submitted_ms, started_ms, finished_ms, reason, name, owner, "    \
    "owner_uid, root"
#define STORE_SCHEMA_DOCUMENT_COLUMNS "job, text"
#define STORE_SCHEMA_ATTEMPT_COLUMNS "job, number, frame, attempt, worker, ended_ms, outcome, log"
#define STORE_SCHEMA_PLAN_COLUMNS "number, owner_uid, scene, segment, text"
#define STORE_SCHEMA_ROOT_COLUMNS "path, id"
#define STORE_SCHEMA_MARK_COLUMNS "job, block, marks"
#define STORE_SCHEMA_USAGE_COLUMNS "owner_uid, used_s, at_ms"
#define STORE_SCHEMA_TOKEN_COLUMNS "id, hash, name, owner, owner_uid, scope, created_ms, expires_ms, used_ms, is_once"
#define STORE_SCHEMA_NOTICE_COLUMNS "id, job, owner_uid, made_ms, event, target, is_webhook, body"
#define STORE_SCHEMA_TOLD_COLUMNS "job, cause, told_ms, is_on"

// Reads a row that starts with the first four of those columns. False for an invalid row.
bool store_schema_read_state(struct sqlite3_stmt *row, struct store_frame *frame, struct error *error);
// Reads `audit`, `measured_error`, `error95`, `audit_rays` and `method`, which are in that column and the next ones.
void store_schema_read_error(struct sqlite3_stmt *row, int column, struct frame_accuracy *accuracy);
// Reads a row of those columns; `frame->error` is borrowed until the next step of the statement.
bool store_schema_read_frame(struct sqlite3_stmt *row, struct store_frame *frame, struct error *error);
