// Who makes which plan: each by one frame's worker at a time, while others wait for it. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Frames with equal keys share plans: those of one owner, with equal pictures, in segments that the worker names alike.
struct plan_key {
    int64_t owner_uid;
    char scene[HASH_TEXT_SIZE];   // hash of the job's pictures
    char segment[HASH_TEXT_SIZE]; // named by workers
};

// An attempt at a frame whose worker asks for a plan.
struct plan_asker {
    int64_t job;
    int32_t frame, attempt;
};

struct plan_errand {
    struct plan_key key;
    struct plan_asker *askers; // owned; the first makes the plan, the others wait
    size_t count, capacity;
    bool is_made; // it is being committed
    struct plan_errand *next;
};

// The zero value is empty.
struct plan_desk {
    struct plan_errand *errands; // owned; the plans that are being made
};

void plan_desk_finish(struct plan_desk *desk);
// True while the plan is being made or committed.
bool plan_desk_is_busy(const struct plan_desk *desk, const struct plan_key *key);
// True when the asker is to make the plan; false: it waits until the plan is closed, or until it is the first. To ask
// again changes nothing.
bool plan_desk_ask(struct plan_desk *desk, const struct plan_key *key, const struct plan_asker *asker);
// True for the one who is to make the plan, until it is made.
bool plan_desk_is_maker(const struct plan_desk *desk, const struct plan_key *key, const struct plan_asker *asker);
// The maker's plan is being committed from here on. False for anybody else.
bool plan_desk_begin_commit(struct plan_desk *desk, const struct plan_key *key, const struct plan_asker *maker);
// The plan is committed. Returns who waits, the maker first unless it left; owned by the caller.
struct plan_asker *plan_desk_close(struct plan_desk *desk, const struct plan_key *key, size_t *count);
// The attempt is over. True when another one is to make a plan in its place; to be called until it is false.
bool plan_desk_leave(struct plan_desk *desk, const struct plan_asker *asker, struct plan_key *key,
                     struct plan_asker *next);
