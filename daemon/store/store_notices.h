// Rows of notices, which wait for march-web to deliver them, and of what jobs have told.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/store/store_op.h"

struct error;
struct sqlite3;
struct store_notices;

// Statements on a connection, which outlives them. NULL on failure.
struct store_notices *store_notices_create(struct sqlite3 *db, struct error *error);
void store_notices_destroy(struct store_notices *notices); // accepts NULL

// STORE_ADD_NOTICE, STORE_DROP_NOTICE and STORE_SET_TOLD.
bool store_notices_apply(struct store_notices *notices, const struct store_op *op, struct error *error);
// What the job has told; its notices stay.
bool store_notices_forget_job(struct store_notices *notices, int64_t job, struct error *error);

typedef bool store_on_notice(void *user, const struct store_notice *notice, struct error *error);
typedef bool store_on_told(void *user, const struct store_told *told, struct error *error);

// Calls `on_notice` for notices with ids above `after`, ascending; what it gets is borrowed during the call.
bool store_notices_read(struct sqlite3 *db, int64_t after, int limit, store_on_notice *on_notice, void *user,
                        struct error *error);
// Likewise for all of them, without their bodies.
bool store_notices_list(struct sqlite3 *db, store_on_notice *on_notice, void *user, struct error *error);
bool store_notices_read_told(struct sqlite3 *db, store_on_told *on_told, void *user, struct error *error); // by job
