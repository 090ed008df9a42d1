// The states of a job's frames, a byte each: what concerns all frames takes a few milliseconds for four million.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/frame_set.h"
#include "daemon/schedule/states.h"

#include <stdbool.h>
#include <stdint.h>

struct frame_attempts;

// Frames are named by their index in the job's range.
struct frame_states {
    int64_t counts[FRAME_STATE_COUNT]; // of frames in each state
    int64_t missed_count;              // of frames that succeeded or were skipped
    int64_t frame_count;
    // For the module only.
    uint8_t *bits;                   // owned; a state and flags
    struct frame_attempts *attempts; // owned
    int64_t *totals;                 // borrowed; counts of the frames of all jobs
};

// What is known of a frame.
struct queue_frame {
    enum frame_state state;
    int32_t attempt;    // number of the latest attempt; it only grows; 0: none
    uint16_t tries;     // attempts that count against max_attempts: those since the latest retry by a user
    uint16_t worker;    // the worker that runs it; 0: none
    bool is_publishing; // its file is being published: the end of the worker no longer matters
    bool is_missed;     // its file is published although it is over the job's tolerance
    bool is_forced;     // it is rendered even if its file is there and good; until the frame is done
};

// All frames are queued. `totals`, of FRAME_STATE_COUNT members, is kept up to date as well; it outlives the states.
void frame_states_init(struct frame_states *states, int64_t frame_count, int64_t *totals);
void frame_states_finish(struct frame_states *states); // its frames leave `totals`

enum { FRAME_STATES_STATE = 7 }; // the bits that are a state

static inline enum frame_state frame_states_get(const struct frame_states *states, int64_t index)
{
    return (enum frame_state)(states->bits[index] & FRAME_STATES_STATE);
}

bool frame_states_is_forced(const struct frame_states *states, int64_t index);
bool frame_states_is_missed(const struct frame_states *states, int64_t index); // as in struct queue_frame
struct queue_frame frame_states_at(const struct frame_states *states, int64_t index);
void frame_states_set(struct frame_states *states, int64_t index, enum frame_state state);
void frame_states_set_attempt(struct frame_states *states, int64_t index, int32_t attempt);      // all of them count
int32_t frame_states_begin_attempt(struct frame_states *states, int64_t index, uint16_t worker); // returns its number
bool frame_states_is_attempt(const struct frame_states *states, int64_t index, int32_t attempt); // that runs
void frame_states_uncount_try(struct frame_states *states, int64_t index);
void frame_states_set_publishing(struct frame_states *states, int64_t index);
void frame_states_set_missed(struct frame_states *states, int64_t index); // until the state changes
void frame_states_set_forced(struct frame_states *states, int64_t index); // until the frame is done
// Whether there are frames to end: queued ones, and running ones that are not being published.
bool frame_states_can_end(const struct frame_states *states);
void frame_states_end(struct frame_states *states, enum frame_state state); // all of those
// Queues the frames of the set with indices in [first, end), forced or not; their tries count no more. Returns their
// number.
int64_t frame_states_requeue(struct frame_states *states, const struct frame_set *indices, int64_t first, int64_t end,
                             bool is_forced);
