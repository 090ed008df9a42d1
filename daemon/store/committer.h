// Commits store ops off the loop: one batch is in flight while the next gathers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include <uv.h>

struct committer;
struct error;
struct store;
struct store_op;

// A batch that fails is tried again every second, for what is in it has happened and must get to the disk.
enum commit_policy {
    COMMIT_SILENT,   // no callback
    COMMIT_CERTAIN,  // the callback comes once the ops are on disk, not before
    COMMIT_REPORTED, // the callback comes after the first try, good or bad; the ops are kept and tried again
    COMMIT_OR_DROP   // the callback comes after the first try; if that failed the ops are gone
};

typedef void committer_on_done(void *user, bool ok, const struct error *error);

struct committer *committer_create(uv_loop_t *loop, struct store *store); // the store is lent until destroy
void committer_destroy(struct committer *committer); // after the loop closed its handles; accepts NULL
// Moves `op_count` ops in. They are committed together, in the order of the calls. `on_done` is called on the loop.
void committer_put(struct committer *committer, enum commit_policy policy, struct store_op *ops, size_t op_count,
                   committer_on_done *on_done, void *user);
// Calls `on_done` when all ops that were put so far have been tried: at once if none waits.
void committer_flush(struct committer *committer, committer_on_done *on_done, void *user);
size_t committer_waiting(const struct committer *committer); // ops that are not on disk yet
bool committer_is_idle(const struct committer *committer);
const char *committer_trouble(const struct committer *committer); // why the last try failed; NULL: it did not
void committer_close(struct committer *committer);                // legal once idle
