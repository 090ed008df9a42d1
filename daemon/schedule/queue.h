// Which frames wait, run and are done: states and answers, no clock, no file, no process.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/frame_range.h"
#include "daemon/schedule/index_heap.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct queue;

enum job_state {
    JOB_QUEUED, // none of its frames has started
    JOB_RUNNING,
    JOB_PAUSED,
    JOB_SUCCEEDED,
    JOB_FAILED,
    JOB_CANCELED,
    JOB_STATE_COUNT
};

enum frame_state {
    FRAME_QUEUED,
    FRAME_RUNNING,
    FRAME_SUCCEEDED,
    FRAME_FAILED,
    FRAME_CANCELED,
    FRAME_SKIPPED,
    FRAME_STATE_COUNT
};

const char *job_state_name(enum job_state state);
const char *frame_state_name(enum frame_state state);
extern const char *const job_state_names[];   // end in NULL
extern const char *const frame_state_names[]; // end in NULL

enum { QUEUE_PRIORITY_LIMIT = 101 }; // a priority is in [0, QUEUE_PRIORITY_LIMIT), higher first

// At most 16 bytes: a million of them are in memory.
struct queue_frame {
    int32_t attempt;    // number of the newest attempt; only grows, so it is never used again; 0: none yet
    uint16_t tries;     // attempts that count against max_attempts: since the frame was last retried by a user
    uint16_t worker;    // that runs it; 0: none
    uint8_t state;      // enum frame_state
    bool is_publishing; // its file is being published: no longer the worker's to lose
};

struct queue_job {
    int64_t id;
    struct frame_range frames;  // owned
    struct queue_frame *states; // owned; by index in the range
    int64_t counts[FRAME_STATE_COUNT];
    int priority;
    bool is_paused;
    bool is_canceled;
    bool is_failed;   // a fault of the job itself
    bool has_started; // some frame was taken since all were queued; the caller sets it for what a store restored
    struct queue_job *next, *previous; // on the queue's list of all jobs: priority, highest first, then id
    // The module's own.
    struct queue *queue; // borrowed; outlives us
    int64_t frame_count;
    int64_t first_fresh;        // a queued frame is at or after this index, or in `returned`
    struct index_heap returned; // owned; queued again after they were taken
};

// One attempt at one frame. From queue_take or queue_ticket_for.
struct queue_ticket {
    int64_t job;
    int32_t frame; // number
    int32_t index; // in the job's range
    int32_t attempt;
};

struct queue *queue_create(int max_attempts); // attempts a frame has before it is failed, [1, 65535]
void queue_destroy(struct queue *queue);      // accepts NULL
void queue_set_max_attempts(struct queue *queue, int max_attempts); // for what fails from now on

// `frames` moves into the queue (left empty). The id must be new. Returns the job.
struct queue_job *queue_add_job(struct queue *queue, int64_t id, struct frame_range *frames, int priority, bool paused);
struct queue_job *queue_find_job(const struct queue *queue, int64_t id); // NULL when there is none
struct queue_job *queue_first_job(const struct queue *queue);            // then ->next
// While loading a store, before the job's first frame is taken: sets one frame's state, not FRAME_RUNNING.
void queue_restore_frame(struct queue_job *job, int64_t index, enum frame_state state, int attempts);
// After its frames, for a job that was canceled or failed as a whole, even if its last frame was then published.
void queue_restore_end(struct queue_job *job, bool canceled, bool failed);

enum job_state queue_job_state(const struct queue_job *job);
bool queue_job_is_live(const struct queue_job *job); // queued, running or paused

// Takes up to `max` frames of one job for `worker` (1..65535): the first live, unpaused job by priority, then id.
// They become FRAME_RUNNING and their attempt counts. Returns how many.
size_t queue_take(struct queue *queue, uint16_t worker, struct queue_ticket *tickets, size_t max);
struct queue_job *queue_next_job(struct queue *queue); // whose frames queue_take would take; NULL: it would take none

// The ticket of a message that names a job, a frame's number and an attempt. False when the queue has no such job or
// the job no such frame; that the attempt is the running one is queue_owns' to say.
bool queue_ticket_for(const struct queue *queue, int64_t job, int32_t frame, int32_t attempt,
                      struct queue_ticket *ticket);

// True while that attempt of the frame is the running one. Everything below that takes a ticket does nothing and
// returns false otherwise: a late answer harms nothing.
bool queue_owns(const struct queue *queue, const struct queue_ticket *ticket);
bool queue_begin_publish(struct queue *queue, const struct queue_ticket *ticket); // false also when it is publishing
bool queue_succeed(struct queue *queue, const struct queue_ticket *ticket);       // also from publishing
bool queue_skip(struct queue *queue, const struct queue_ticket *ticket);
// The attempt failed: the frame is queued again, or failed (*is_final, may be NULL) when it had its attempts, or when
// `final` says so. A frame that was publishing when its job was canceled or failed becomes that; also in queue_return.
bool queue_fail(struct queue *queue, const struct queue_ticket *ticket, bool final, bool *is_final);
// The frame goes back and the attempt does not count against max_attempts, yet its number is not used again.
bool queue_return(struct queue *queue, const struct queue_ticket *ticket);

void queue_set_priority(struct queue *queue, struct queue_job *job, int priority);
void queue_pause(struct queue *queue, struct queue_job *job);
void queue_resume(struct queue *queue, struct queue_job *job);
// Queued frames become canceled; running ones are the caller's to stop: their tickets no longer own anything.
// Frames being published are left to succeed. Does nothing to a job that is not live.
void queue_cancel(struct queue *queue, struct queue_job *job);
// The job's own fault: like cancel, but its frames become failed.
void queue_fail_job(struct queue *queue, struct queue_job *job);
// Frames in one of `states` (bit 1 << enum frame_state) and in `range` (NULL: all) are queued again with no attempts
// counted; a canceled or failed job lives again. Queued and running frames are left alone. Returns how many.
int64_t queue_retry(struct queue *queue, struct queue_job *job, unsigned states, const struct frame_range *range);
// The indices of the frames that such a retry would queue, ascending; owned by the caller, NULL when there are none.
size_t queue_find_frames(const struct queue_job *job, unsigned states, const struct frame_range *range,
                         int32_t **indices);
// Takes the job out and frees it; its tickets no longer own anything.
void queue_remove_job(struct queue *queue, struct queue_job *job);

int64_t queue_count(const struct queue *queue, enum frame_state state); // over all jobs
