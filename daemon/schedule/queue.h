// The queue of frames: their states, and which is next. Pure: no clock, no file, no process.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/frame_order.h"
#include "core/job/frame_range.h"
#include "core/job/frame_set.h"
#include "daemon/schedule/frame_states.h"
#include "daemon/schedule/index_heap.h"
#include "daemon/schedule/states.h"
#include "daemon/schedule/turns.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct queue;

// Priorities are in [0, QUEUE_PRIORITY_LIMIT); the highest is first.
enum { QUEUE_PRIORITY_LIMIT = TURNS_PRIORITY_LIMIT };

// Why no frame of a job is taken, apart from what users and the job itself decide.
enum queue_block {
    QUEUE_OPEN,
    QUEUE_IN_DOUBT, // for a moment: whether its output can be written is being looked at
    QUEUE_AWAY      // its output root is not there: the job is paused
};

// Whether a job comes after others.
enum queue_wait {
    QUEUE_WAITS_NOT,
    QUEUE_WAITS,        // until they are over: it is queued
    QUEUE_WAITS_IN_VAIN // one of them did not succeed: it is paused
};

struct queue_job {
    int64_t id;
    struct turns_job turn;      // its owner, and whether it has frames to take
    struct frame_range frames;  // owned
    struct frame_states states; // by index in the range; changed by the queue alone
    int priority;
    bool is_paused;
    enum queue_block block;
    enum queue_wait wait;
    bool is_canceled;
    bool is_failed;                    // by a fault of the job itself
    bool has_started;                  // a frame was taken since all were queued; the caller sets it for a restored job
    struct queue_job *next, *previous; // on the queue's list of all jobs: by priority, highest first, then by id
    // For the module only.
    struct queue *queue; // borrowed; outlives us
    struct frame_order order;
    int64_t next_position;      // in the order: every queued frame is there or later, or in `returned`
    struct index_heap returned; // owned; frames that were queued again after they were taken
};

// One attempt at one frame, from queue_take.
struct queue_ticket {
    int64_t job;
    int32_t frame; // number
    int32_t index; // in the job's range
    int32_t attempt;
    bool is_forced; // as in struct queue_frame
};

struct queue *queue_create(int max_attempts); // attempts of a frame before it is failed, in [1, 65535]
void queue_destroy(struct queue *queue);      // accepts NULL
void queue_set_max_attempts(struct queue *queue, int max_attempts); // holds for later failures

struct queue_job_params {
    int64_t id; // new
    int64_t owner_uid;
    struct frame_range *frames; // moves into the queue and is left empty
    int priority;
    uint64_t barred; // as in struct turns_job
    bool is_paused;
    bool waits;                      // QUEUE_WAITS
    const struct frame_order *order; // copied; NULL: as written
};

struct queue_job *queue_add_job(struct queue *queue, const struct queue_job_params *params);
struct queue_job *queue_find_job(const struct queue *queue, int64_t id); // NULL: none
struct queue_job *queue_first_job(const struct queue *queue);            // the others follow by ->next
// Sets one frame's state, other than FRAME_RUNNING, while the store is loaded, before a frame of the job is taken.
void queue_restore_frame(struct queue_job *job, int64_t index, enum frame_state state, int attempts);
// To be called after the frames, for a job that was canceled or failed as a whole, even if its last frame was published
// then.
void queue_restore_end(struct queue_job *job, bool canceled, bool failed);

enum job_state queue_job_state(const struct queue_job *job);
bool queue_job_is_live(const struct queue_job *job); // queued, running or paused

struct turns *queue_turns(struct queue *queue); // of its jobs
// The jobs with frames to take, as turns_next_ready. NULL for `job`: the first; NULL: there are no more.
struct queue_job *queue_next_ready(const struct queue *queue, const struct queue_job *job);
// The job that the seat serves next; NULL: none has a frame to take. NULL for `seat` is a worker of kind 0.
struct queue_job *queue_choose_job(const struct queue *queue, const struct turns_seat *seat);
// Takes up to `max` frames of the job for `worker` (1..65535). They become FRAME_RUNNING and their attempt counts.
// Returns their number, which is 0 for a job that is over or paused. It may also be 0, or less than there are, when the
// next frame is not found in a millisecond or two: then call again.
size_t queue_take(struct queue_job *job, uint16_t worker, struct queue_ticket *tickets, size_t max);

// True while that attempt of the frame is the running one. Otherwise every function below that takes a ticket does
// nothing and returns false, so that late reports have no effect.
bool queue_owns(const struct queue *queue, const struct queue_ticket *ticket);
bool queue_begin_publish(struct queue *queue, const struct queue_ticket *ticket); // false also while it is published
bool queue_succeed(struct queue *queue, const struct queue_ticket *ticket);       // also while it is being published
bool queue_skip(struct queue *queue, const struct queue_ticket *ticket);
// The frame of that index was queued, and its file turns out to be published: it succeeded. False where it is not
// queued.
bool queue_find_published(struct queue_job *job, int64_t index);
// Notes that the published file of that frame is over the job's tolerance, until the frame is queued again.
void queue_note_missed(struct queue_job *job, int64_t index);
// The attempt failed. The frame is queued again, or failed when it has no attempts left or `final` is true; `*is_final`
// (may be NULL) says which. A frame that was being published when its job was canceled or failed becomes canceled or
// failed; also in queue_return.
bool queue_fail(struct queue *queue, const struct queue_ticket *ticket, bool final, bool *is_final);
// The frame is queued again and the attempt does not count against max_attempts; its number is not used again.
bool queue_return(struct queue *queue, const struct queue_ticket *ticket);

void queue_set_priority(struct queue *queue, struct queue_job *job, int priority);
void queue_set_barred(struct queue *queue, struct queue_job *job, uint64_t barred); // as in struct turns_job
void queue_pause(struct queue *queue, struct queue_job *job);
void queue_resume(struct queue *queue, struct queue_job *job);
// Whether queue_cancel would cancel a frame: not when all that are not over are being published.
bool queue_has_frame_to_cancel(const struct queue_job *job);
void queue_set_block(struct queue *queue, struct queue_job *job, enum queue_block block);
void queue_set_wait(struct queue_job *job, enum queue_wait wait);
// Queued and running frames become canceled: tickets of running frames own them no more, and the caller stops the
// workers. Frames that are being published may still succeed. Does nothing to a job that is not live.
void queue_cancel(struct queue *queue, struct queue_job *job);
// As queue_cancel for a fault of the job: its frames become failed.
void queue_fail_job(struct queue *queue, struct queue_job *job);
// Queues frames again, with no attempts counted: those of the set with indices in [first, end), none of which is queued
// or running. A job that is over is live again, and not paused even if it ended so. With `is_forced` they are rendered
// even if their files are there and good. Returns their number.
int64_t queue_retry(struct queue_job *job, const struct frame_set *indices, int64_t first, int64_t end, bool is_forced);
// The queued frame of that index is rendered even if its file is there and good.
void queue_force_frame(struct queue_job *job, int64_t index);
// Removes and frees the job; its tickets own nothing any more.
void queue_remove_job(struct queue *queue, struct queue_job *job);

int64_t queue_count(const struct queue *queue, enum frame_state state); // of all jobs
