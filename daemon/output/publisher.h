// Gives finished files their names: intent on disk first, then renames in batches off the loop, a sync a folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/error.h"
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
    PUBLISH_OUTCOME_DONE,
    PUBLISH_OUTCOME_BAD_FILE,  // the part is not what the worker said
    PUBLISH_OUTCOME_BAD_FOLDER // it cannot be opened or synced: every frame would meet it
};

// One frame to publish, and what became of it.
struct publish_request {
    struct job_record *record; // borrowed; outlives us
    struct queue_ticket ticket;
    int worker;    // that made it
    int64_t epoch; // whose part file it is
    struct published_file file;
    double render_s, encode_s;
    struct frame_accuracy accuracy;
    enum publish_outcome outcome;
    struct error error;
};

// Called on the loop once the file has its name, durably, or will not have it. The result is the callee's to commit.
typedef void publisher_on_done(void *user, const struct publish_request *request);

struct publisher *publisher_create(uv_loop_t *loop, struct committer *committer, publisher_on_done *on_done,
                                   void *user);
void publisher_destroy(struct publisher *publisher);                                    // legal once idle; accepts NULL
void publisher_put(struct publisher *publisher, const struct publish_request *request); // copies
bool publisher_is_idle(const struct publisher *publisher);

// The frame's row for the store, in the given state.
struct store_op publish_request_format_op(const struct publish_request *request, enum frame_state state);
