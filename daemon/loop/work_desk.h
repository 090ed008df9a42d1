// Work for clients off the loop: two pieces at a time, and users in turn.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include <uv.h>

struct work_desk;

// One piece of work. It belongs to the caller, who sets the first members.
struct work_piece {
    void (*run)(struct work_piece *piece);                // in a thread
    void (*done)(struct work_piece *piece, bool was_run); // on the loop; the piece may be freed
    int64_t uid;                                          // for whom it is
    bool goes_on; // it ends what a piece before it has begun, and holds its memory: it is next, whoever waits
    // For the module only.
    uv_work_t work;
    struct work_desk *desk;
    struct work_piece *next; // on the list of those that wait, or of those that run
    uint64_t round;
};

struct work_desk *work_desk_create(uv_loop_t *loop);
void work_desk_destroy(struct work_desk *desk); // when it is idle; accepts NULL

// Threads are left for commits and publishing, however much work there is. Each user has one piece a round: one who
// comes with the first piece is next, whatever another has brought before.
void work_desk_put(struct work_desk *desk, struct work_piece *piece);
// What waits is done with, unrun, and so is all that comes later.
void work_desk_stop(struct work_desk *desk);
bool work_desk_is_idle(const struct work_desk *desk);
