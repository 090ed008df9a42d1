// Reads of rows that the queue does not keep in memory: frames, attempts, job documents, plans.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/root_marker.h"
#include "daemon/store/store.h"
#include "daemon/store/store_notices.h"
#include "daemon/store/store_tokens.h"

struct store_reader;

// A read-only connection, for any thread, one at a time, while the store is open elsewhere. Blocking.
struct store_reader *store_reader_open(const char *folder, struct error *error); // NULL on failure
void store_reader_close(struct store_reader *reader);                            // accepts NULL

// Calls `on_frame` with the complete row of each frame with index in [first, last], ascending; frames without a row are
// left out.
bool store_read_frames(struct store_reader *reader, int64_t job, int32_t first, int32_t last, store_on_frame *on_frame,
                       void *user, struct error *error);
typedef bool store_on_attempt(void *user, const struct store_attempt *attempt, struct error *error);
// Newest first. `frame` -1: of all frames.
bool store_read_attempts(struct store_reader *reader, int64_t job, int32_t frame, int limit,
                         store_on_attempt *on_attempt, void *user, struct error *error);
// `*document` is the job file as text, owned by the caller; NULL on failure. It is an error when the store has no such
// job.
bool store_read_document(struct store_reader *reader, int64_t job, char **document, struct error *error);
// `farm` is the id of this farm, which is made with the store and never changes.
bool store_read_farm(struct store_reader *reader, char farm[static ROOT_MARKER_ID_SIZE], struct error *error);
typedef bool store_on_root(void *user, const struct store_root *root, struct error *error);
bool store_read_roots(struct store_reader *reader, store_on_root *on_root, void *user, struct error *error); // by path
typedef bool store_on_usage(void *user, const struct store_usage *usage, struct error *error);
bool store_read_usage(struct store_reader *reader, store_on_usage *on_usage, void *user, struct error *error); // by uid
// As store_tokens_read.
bool store_read_tokens(struct store_reader *reader, store_on_token *on_token, void *user, int64_t *last_id,
                       struct error *error);
// The newest plan of the key; its text is owned by the caller. `*number` is 0 and `*text` NULL where there is none.
bool store_read_plan(struct store_reader *reader, const struct plan_key *key, int64_t *number, char **text,
                     struct error *error);
// As store_notices_read, store_notices_list and store_notices_read_told.
bool store_read_notices(struct store_reader *reader, int64_t after, int limit, store_on_notice *on_notice, void *user,
                        struct error *error);
bool store_list_notices(struct store_reader *reader, store_on_notice *on_notice, void *user, struct error *error);
bool store_read_told(struct store_reader *reader, store_on_told *on_told, void *user, struct error *error);
typedef bool store_on_plan(void *user, int64_t number, const char *text, struct error *error);
// Those of an owner for pictures of that hash, whatever their segments, the newest first. `text` is borrowed.
bool store_read_plans(struct store_reader *reader, int64_t owner_uid, const char *scene, int limit,
                      store_on_plan *on_plan, void *user, struct error *error);
