// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/frame_states.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <stdlib.h>

// Flags beside the state. A frame with TRIED has `tries`.
enum { PUBLISHING = 8, MISSED = 16, FORCED = 32, TRIED = 64 };
static_assert((int)FRAME_STATE_COUNT <= (int)FRAME_STATES_STATE + 1, "a state has three bits");

// Only frames that are tried touch this memory.
struct frame_attempts {
    int32_t attempt;
    uint16_t tries, worker;
};

void frame_states_init(struct frame_states *states, int64_t frame_count, int64_t *totals)
{
    *states = (struct frame_states){.frame_count = frame_count, .totals = totals};
    states->bits = xcalloc((size_t)frame_count, sizeof states->bits[0]); // FRAME_QUEUED
    states->attempts = xcalloc((size_t)frame_count, sizeof states->attempts[0]);
    states->counts[FRAME_QUEUED] = frame_count;
    totals[FRAME_QUEUED] += frame_count;
}

void frame_states_finish(struct frame_states *states)
{
    for (int state = 0; state < FRAME_STATE_COUNT && states->totals; state++)
        states->totals[state] -= states->counts[state];
    free(states->bits);
    free(states->attempts);
    *states = (struct frame_states){0};
}

bool frame_states_is_forced(const struct frame_states *states, int64_t index)
{
    return states->bits[index] & FORCED;
}

bool frame_states_is_missed(const struct frame_states *states, int64_t index)
{
    return states->bits[index] & MISSED;
}

struct queue_frame frame_states_at(const struct frame_states *states, int64_t index)
{
    const struct frame_attempts *attempts = &states->attempts[index];
    enum frame_state state = frame_states_get(states, index);
    int bits = states->bits[index];

    return (struct queue_frame){.state = state,
                                .attempt = attempts->attempt,
                                .tries = bits & TRIED ? attempts->tries : 0,
                                .worker = state == FRAME_RUNNING ? attempts->worker : 0,
                                .is_publishing = bits & PUBLISHING,
                                .is_missed = bits & MISSED,
                                .is_forced = bits & FORCED};
}

// Counts frames that left each state for another.
static void move_counts(struct frame_states *states, const int64_t left[static FRAME_STATE_COUNT],
                        enum frame_state state)
{
    for (int from = 0; from < FRAME_STATE_COUNT; from++) {
        states->counts[from] -= left[from];
        states->totals[from] -= left[from];
        states->counts[state] += left[from];
        states->totals[state] += left[from];
    }
}

void frame_states_set(struct frame_states *states, int64_t index, enum frame_state state)
{
    int bits = states->bits[index], kept = TRIED;

    if (state == FRAME_QUEUED || state == FRAME_RUNNING) kept |= FORCED;
    if (state == FRAME_RUNNING) kept |= PUBLISHING;
    if (bits & MISSED) states->missed_count--;
    states->counts[bits & FRAME_STATES_STATE]--;
    states->totals[bits & FRAME_STATES_STATE]--;
    states->counts[state]++;
    states->totals[state]++;
    states->bits[index] = (uint8_t)((bits & kept) | (int)state);
}

static void set_tries(struct frame_states *states, int64_t index, int tries)
{
    states->attempts[index].tries = (uint16_t)(tries < 0 ? 0 : tries < UINT16_MAX ? tries : UINT16_MAX);
    states->bits[index] |= TRIED;
}

void frame_states_set_attempt(struct frame_states *states, int64_t index, int32_t attempt)
{
    states->attempts[index].attempt = attempt;
    set_tries(states, index, attempt);
}

int32_t frame_states_begin_attempt(struct frame_states *states, int64_t index, uint16_t worker)
{
    set_tries(states, index, frame_states_at(states, index).tries + 1);
    frame_states_set(states, index, FRAME_RUNNING);
    states->attempts[index].worker = worker;
    return ++states->attempts[index].attempt;
}

bool frame_states_is_attempt(const struct frame_states *states, int64_t index, int32_t attempt)
{
    return frame_states_get(states, index) == FRAME_RUNNING && states->attempts[index].attempt == attempt;
}

void frame_states_uncount_try(struct frame_states *states, int64_t index)
{
    set_tries(states, index, frame_states_at(states, index).tries - 1);
}

void frame_states_set_publishing(struct frame_states *states, int64_t index)
{
    assert(frame_states_get(states, index) == FRAME_RUNNING);
    states->bits[index] |= PUBLISHING;
}

void frame_states_set_missed(struct frame_states *states, int64_t index)
{
    assert(frame_states_get(states, index) == FRAME_SUCCEEDED || frame_states_get(states, index) == FRAME_SKIPPED);
    if (!(states->bits[index] & MISSED)) states->missed_count++;
    states->bits[index] |= MISSED;
}

void frame_states_set_forced(struct frame_states *states, int64_t index)
{
    assert(frame_states_get(states, index) == FRAME_QUEUED);
    states->bits[index] |= FORCED;
}

static bool would_end(int bits)
{
    int state = bits & FRAME_STATES_STATE;

    return state == FRAME_QUEUED || (state == FRAME_RUNNING && !(bits & PUBLISHING));
}

bool frame_states_can_end(const struct frame_states *states)
{
    bool found = states->counts[FRAME_QUEUED] > 0;

    for (int64_t i = 0; i < states->frame_count && !found; i++)
        found = would_end(states->bits[i]);
    return found;
}

void frame_states_end(struct frame_states *states, enum frame_state state)
{
    int64_t left[FRAME_STATE_COUNT] = {0}, frame_count = states->frame_count;
    uint8_t *bits = states->bits;

    for (int64_t i = 0; i < frame_count; i++) {
        if (!would_end(bits[i])) continue;
        left[bits[i] & FRAME_STATES_STATE]++;
        bits[i] = (uint8_t)((bits[i] & TRIED) | (int)state);
    }
    move_counts(states, left, state);
}

int64_t frame_states_requeue(struct frame_states *states, const struct frame_set *indices, int64_t first, int64_t end,
                             bool is_forced)
{
    int64_t left[FRAME_STATE_COUNT] = {0}, count = 0;
    uint8_t *bits = states->bits;

    for (int64_t i = frame_set_next(indices, first); i < end; i = frame_set_next(indices, i + 1)) {
        left[bits[i] & FRAME_STATES_STATE]++;
        if (bits[i] & MISSED) states->missed_count--;
        bits[i] = (uint8_t)((int)FRAME_QUEUED | (is_forced ? FORCED : 0));
        count++;
    }
    move_counts(states, left, FRAME_QUEUED);
    return count;
}
