// The store's tables, their version, and a frame's row.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct sqlite3;
struct sqlite3_stmt;
struct store_frame;

#define STORE_SCHEMA_VERSION 3 // a macro because SQL text holds it

// Whether this version may use the database, and which one wrote it (0: it is empty); changes nothing.
bool store_schema_check(struct sqlite3 *db, int *found, struct error *error);
// Makes the tables, or what this version has beside those of the one found. Inside a transaction.
bool store_schema_upgrade(struct sqlite3 *db, int found, struct error *error);

// In the order of store_schema_read_frame.
#define STORE_SCHEMA_FRAME_COLUMNS                                                                                     \
    "job, frame_index, state, attempts, epoch, inode, size_bytes, hash, render_s, encode_s, error, audit, "            \
    "measured_error, error95, audit_rays, method, cut_share"

// From a row of the first four of those columns. False when the row cannot be.
bool store_schema_read_state(struct sqlite3_stmt *row, struct store_frame *frame, struct error *error);
// From a row of those columns; `frame->error` is lent until the next step.
bool store_schema_read_frame(struct sqlite3_stmt *row, struct store_frame *frame, struct error *error);
