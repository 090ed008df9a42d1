// The frames assigned to a worker and their jobs: which frames wait, are started, or are no longer wanted.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "core/job/job_beyond.h"
#include "worker/process/old_parts.h"
#include "worker/process/plan_mail.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// A job of which the worker was told. Once it is added, only its plans, its frame count and is_forgotten change.
struct held_job {
    int64_t id, epoch;
    int64_t serial; // unique among all jobs of this worker; 0 until the job is added
    char *root;     // owned
    char *root_id;  // owned; of the root's marker; NULL: its folder is not checked
    char *farm_id;  // owned; for the names of part files and headers; NULL: none
    char *node;     // owned; the name by which the farm knows this machine; NULL: none
    char *owner;    // owned
    struct job job;
    bool has_old_parts;         // part files of an earlier daemon may be there
    struct old_parts old_parts; // of the rendering thread
    char *draft;                // owned; how a draft's settings were chosen; NULL: the job is no draft
    char *fault;                // owned; why none of its frames can be rendered; NULL if they can
    bool asks_plans;            // its plans are kept by who sent it
    char *plan_of;              // owned; the file whose settings its frames have; NULL: none
    char *preview;              // owned; the file that shows a frame as it refines; NULL: none
    int64_t stated_number;      // of that file's plan
    struct job_quality stated;
    struct job_beyond stated_beyond;
    struct plan_mail plans; // guarded by the worker's lock
    size_t frame_count;     // of its frames in the assignment
    bool is_forgotten;      // freed with its last frame
    struct held_job *next;  // in the assignment's list of jobs
};

struct held_job *held_job_create(void);
void held_job_destroy(struct held_job *job); // accepts NULL

struct assignment_frame {
    struct held_job *job; // borrowed; lives as long as the frame
    int32_t frame;
    int attempt;
    bool is_forced; // rendered even if its file is there and good
    bool is_started;
    bool is_unwanted;              // started, but to be dropped
    struct assignment_frame *next; // in the assignment's list of frames
};

// The zero value is empty.
struct assignment {
    struct held_job *jobs;           // owned
    struct assignment_frame *frames; // owned; in the order to render them
    int64_t job_count;               // of all jobs ever added
};

void assignment_finish(struct assignment *assignment);

// Takes the job over. A job of the same id is forgotten.
void assignment_add_job(struct assignment *assignment, struct held_job *job);
// Frees the job now or with its last frame. Does nothing for an unknown job.
void assignment_forget_job(struct assignment *assignment, int64_t id);
// Appends and returns the frame; NULL when the job is unknown.
struct assignment_frame *assignment_add_frame(struct assignment *assignment, int64_t job, int32_t frame, int attempt);

// NULL: an unknown job.
struct held_job *assignment_find_job(const struct assignment *assignment, int64_t id);

// Starts the next waiting frame; NULL when none waits. The frame belongs to the assignment until it is ended.
struct assignment_frame *assignment_start_frame(struct assignment *assignment);
// The next waiting frame, left waiting; NULL when none waits.
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
