// The frames a worker has in hand and the jobs they belong to: what waits, what is started, what is no longer wanted.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// A job the worker was told of. Only its list of frames changes once it is added.
struct held_job {
    int64_t id, epoch;
    int64_t serial; // that no other job has which the worker was told of; 0 until it is added
    char *root;     // owned
    char *owner;    // owned
    struct job job;
    char *fault;           // owned; why no frame of it can work, NULL if they can
    size_t frame_count;    // of its frames in hand
    bool is_forgotten;     // freed with its last frame
    struct held_job *next; // on the assignment's list of jobs
};

struct held_job *held_job_create(void);
void held_job_destroy(struct held_job *job); // accepts NULL

struct assignment_frame {
    struct held_job *job; // borrowed; lives as long as the frame is in hand
    int32_t frame;
    int attempt;
    bool is_started;
    bool is_unwanted;              // started, but to be given back
    struct assignment_frame *next; // on the assignment's list of frames
};

// The zero value is empty.
struct assignment {
    struct held_job *jobs;           // owned
    struct assignment_frame *frames; // owned; in the order to render them
    int64_t job_count;               // that were ever added
};

void assignment_finish(struct assignment *assignment);

// Takes the job over. One of the same id is forgotten.
void assignment_add_job(struct assignment *assignment, struct held_job *job);
// Frees the job now or with its last frame. Nothing happens when it is not known.
void assignment_forget_job(struct assignment *assignment, int64_t id);
// Puts the frame behind those in hand; false when the job is not known.
bool assignment_add_frame(struct assignment *assignment, int64_t job, int32_t frame, int attempt);

// The next frame that waits, now started; NULL when none does. Belongs to the assignment until it is ended.
struct assignment_frame *assignment_start_frame(struct assignment *assignment);
// The same frame, left waiting.
const struct assignment_frame *assignment_find_waiting(const struct assignment *assignment);
void assignment_end_frame(struct assignment *assignment, struct assignment_frame *frame);

struct assignment_dropped {
    int64_t job;
    int32_t frame;
    int attempt;
};

enum { ASSIGNMENT_ANY_JOB = -1 };

// Removes the first waiting frame of the job; false when there is none left.
bool assignment_drop_waiting(struct assignment *assignment, int64_t job, struct assignment_dropped *dropped);
// Marks the job's started frames as unwanted.
void assignment_unwant_started(struct assignment *assignment, int64_t job);
