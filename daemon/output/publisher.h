// Publishes finished files: commits the intent, then renames in batches off the loop, with one sync per folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/frame_accuracy.h"
#include "core/wire/publish.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store_op.h"

#include <stdbool.h>
#include <stdint.h>

#include <uv.h>

struct committer;
struct job_record;
struct publisher;

enum publish_outcome {
    PUBLISH_OUTCOME_DONE,       // the file has its name, is on disk, and the root with it was still there afterwards
    PUBLISH_OUTCOME_BAD_FILE,   // the part file differs from the report of the worker
    PUBLISH_OUTCOME_BAD_FOLDER, // the folder cannot be opened or synced: every frame would fail
    PUBLISH_OUTCOME_NO_ROOT     // the output root is not there, or was taken away meanwhile, with or without the file
};

// One frame to publish, or one whose file a worker found, and the outcome.
struct publish_request {
    bool is_found; // the file has its name already, says the worker: it is only looked at; `file` has no inode
    struct job_record *record; // borrowed; outlives us
    struct queue_ticket ticket;
    int worker;           // id of the worker that rendered it
    uint64_t seen_by_ns;  // monotonic; until then the file of another machine is awaited; 0: it was written here
    uint64_t reported_ns; // monotonic; when the worker said that it is there; 0: unknown
    int64_t epoch;        // of the part file
    struct published_file file;
    double render_s, encode_s, audit_s;
    struct frame_accuracy accuracy;
    enum publish_outcome outcome;
    char *error; // owned by the publisher; what is wrong; NULL: nothing
};

enum { PUBLISHER_SEEN_MS = 5000 }; // so long may what another machine wrote take to be seen

enum {
    PUBLISHER_BATCH = 256,     // most requests that are looked at or renamed together; so many wait for no other batch
    PUBLISHER_HANDS = 4,       // batches at once in an output root
    PUBLISHER_FULL = 16 * 1024 // requests with which a publisher is full
};

// Called on the loop when the file is published on disk, or cannot be. The callee commits the result.
typedef void publisher_on_done(void *user, const struct publish_request *request);

// Each output root has threads of its own. `farm` is the farm's id, borrowed.
struct publisher *publisher_create(uv_loop_t *loop, const char *farm, struct committer *committer,
                                   publisher_on_done *on_done, void *user);
void publisher_destroy(struct publisher *publisher);                                    // legal once idle; accepts NULL
void publisher_put(struct publisher *publisher, const struct publish_request *request); // copies
// Has the file that a worker found looked at, by size and hash: nothing is committed, renamed or synced.
void publisher_put_found(struct publisher *publisher, const struct publish_request *request); // copies
bool publisher_is_idle(const struct publisher *publisher);
// So many wait that no frame which would join them is to be begun.
bool publisher_is_full(const struct publisher *publisher);

// An op that stores the frame's row in the given state.
struct store_op publish_request_format_op(const struct publish_request *request, enum frame_state state);
