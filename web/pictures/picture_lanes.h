// Threads that look at files of disks that may not answer: one for each disk at a time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

struct picture_lanes;

enum {
    LANE_THREAD_LIMIT = 16,  // so many disks may be silent before others wait for them
    LANE_WAIT_LIMIT = 256,   // tasks of one lane that have not begun
    LANE_PATIENCE_MS = 1000, // for threads that are at work when all ends
};

// What is to be done. It is in the memory of its owner.
struct lane_task {
    struct lane_task *next; // in its lane
};

struct picture_lanes_params {
    void (*run)(struct lane_task *task);              // by a thread, and may never return: it touches the task alone
    void (*done)(struct lane_task *task, void *user); // by the same thread afterwards; never after picture_lanes_stop
    void (*release)(struct lane_task *task);          // in place of `done`, when all ends; it frees the task
    void *user;
    int late_ms; // a lane whose task takes longer refuses others meanwhile
};

enum lane_entry {
    LANE_ENTERED,
    LANE_FULL, // too many wait in it, or there can be no thread
    LANE_LATE  // it does not get on
};

struct picture_lanes *picture_lanes_create(const struct picture_lanes_params *params);
// Tasks of one lane are run one after the other, those of several at a time. What is refused stays the caller's.
enum lane_entry picture_lanes_add(struct picture_lanes *lanes, const char *lane, struct lane_task *task);
// Releases what waits. A thread that does not return within a moment is left to itself: it releases its task when it
// does, or ends with the process. Frees `lanes`.
void picture_lanes_stop(struct picture_lanes *lanes);
