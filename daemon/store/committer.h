// Commits store ops off the loop: one batch is in flight while the next is collected.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include <uv.h>

struct committer;
struct error;
struct histogram;
struct store;
struct store_op;

// A failed batch is tried again every second: its changes have been made in memory and must be stored. While the store
// is in trouble, nothing new should be begun. Trouble ends when a commit succeeds and the reserve is there again, which
// is tried every second too.
enum commit_policy {
    COMMIT_SILENT,   // no callback
    COMMIT_CERTAIN,  // the callback comes when the ops are on disk
    COMMIT_REPORTED, // the callback comes after the first try, failed or not; failed ops are tried again
    COMMIT_OR_DROP   // the callback comes after the first try; failed ops are dropped
};

typedef void committer_on_done(void *user, bool ok, const struct error *error);
typedef void committer_on_trouble(void *user); // the trouble began, has another reason, or ended

struct committer *committer_create(uv_loop_t *loop, struct store *store); // `store` is borrowed until committer_destroy
void committer_watch(struct committer *committer, committer_on_trouble *on_trouble, void *user); // one watcher
void committer_destroy(struct committer *committer); // after the loop closed its handles; accepts NULL
// Moves `op_count` ops in. They are committed together, in the order of the calls. `on_done` is called on the loop.
void committer_put(struct committer *committer, enum commit_policy policy, struct store_op *ops, size_t op_count,
                   committer_on_done *on_done, void *user);
// Calls `on_done` when all ops that were put so far were tried; at once when there are none.
void committer_flush(struct committer *committer, committer_on_done *on_done, void *user);
size_t committer_waiting(const struct committer *committer); // count of ops that are not on disk
bool committer_is_idle(const struct committer *committer);
// Why the store takes nothing new, as a sentence; NULL: it does. With `has_failed`, nothing is committed at present;
// without, what is in flight is committed by means of the reserve.
const char *committer_trouble(const struct committer *committer);
bool committer_has_failed(const struct committer *committer);
// Seconds from a change until it is on disk, of the oldest change of each commit; histogram_latency_s.
const struct histogram *committer_seconds(const struct committer *committer);
void committer_close(struct committer *committer); // legal once idle
