// Which picture is made next, and who waits for it. No clock, no thread, no file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PICTURE_WAIT_LIMIT = 256, PICTURE_USER_WAIT_LIMIT = 64, PICTURE_QUEUE_USERS = 64 };

struct picture_task;

// Who waits. It is in the memory of its owner, who fills in the first two.
struct picture_waiter {
    int64_t user;
    char key[HASH_TEXT_SIZE];
    struct picture_task *task;   // NULL: it waits for nothing
    struct picture_waiter *next; // in the task's list
};

// A picture that is waited for.
struct picture_task {
    struct picture_waiter *waiters; // at least one, but while it is made
    bool is_made;                   // a worker is at it
    int64_t user;                   // whose turn it takes: the first waiter's
    struct picture_task *next;      // in the queue, oldest first
};

// The zero value is empty.
struct picture_queue {
    struct picture_task *tasks; // owned
    size_t waiter_count;
    struct {
        int64_t user;
        uint64_t turn; // of its last picture; 0: none
    } users[PICTURE_QUEUE_USERS];
    uint64_t turn;
};

// Has the waiter wait for its picture, which is made once for all who wait. False: too many wait, all together or of
// this user. `*is_new`: a maker has to be told.
bool picture_queue_add(struct picture_queue *queue, struct picture_waiter *waiter, bool *is_new);
// The next picture to make: the oldest of the user whose last turn is longest ago. NULL: there is none.
struct picture_task *picture_queue_take(struct picture_queue *queue);
// The waiter gives up. A picture that nobody waits for is not begun; one that is being made goes on.
void picture_queue_drop(struct picture_queue *queue, struct picture_waiter *waiter);
// Ends a task that was taken; returns the list of those who still wait for it, who then wait for nothing.
struct picture_waiter *picture_queue_end(struct picture_queue *queue, struct picture_task *task);
