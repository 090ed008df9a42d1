// What a worker's threads share: one reads orders, one renders and answers, one encodes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/picture/ray_counts.h"
#include "worker/plan/plan.h"
#include "worker/process/assignment.h"
#include "worker/process/connection.h"
#include "worker/sandbox/sandbox.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

struct error;
struct options;
struct request;

// A frame between the renderer and the encoder.
struct picture {
    struct assignment_frame *frame; // borrowed from the assignment
    struct image image;
    int folder_fd; // owned; where its file goes
    double world_to_camera[16], world_to_ndc[16];
    double render_s;
    enum job_method method; // that rendered it: the job's, or what a plan put in place of auto
    double step;            // m; likewise
    struct ray_counts ray_counts;
    struct audit_result audit;   // AUDIT_NONE: the job states no tolerance
    double sampling_error;       // relative RMSE that the number of samples a pixel leaves; 0: not measured
    char plan[PLAN_REASON_SIZE]; // why this method and these numbers; empty: the job says them
    char shader_hash[64];
    char hash[HASH_TEXT_SIZE]; // of the job and of what the frame's files hold
};

void picture_destroy(struct picture *picture); // accepts NULL

struct worker {
    const struct options *options; // borrowed; outlives us
    struct connection connection;
    int wake_fd;                     // readable once a thread has ended
    atomic_ullong progress;          // grows whenever rendering or encoding moves on
    char backend[16];                // set before the first frame, then constant
    char renderer[128];              // likewise
    char sandbox[SANDBOX_TEXT_SIZE]; // likewise; what it sees to

    pthread_mutex_t lock; // guards what follows
    pthread_cond_t changed;
    struct assignment assignment;
    struct request *requests; // owned; oldest first
    struct picture *rendered; // owned; waits for the encoder. While it does, no other frame is begun.
    struct image spare;       // owned; what the next picture is made of; empty while no frame is in hand
    bool is_ready;            // worker.ready is sent
    bool is_exiting;          // no new frames; what is started is finished
    bool is_abandoned;        // nobody listens: everything is let go at once
    bool has_renderer_ended;  // the encoder ends when it has nothing left
    int running_threads;
    int exit_code;
};

bool worker_init(struct worker *worker, const struct options *options);
void worker_finish(struct worker *worker); // after its threads have ended

void worker_advance(struct worker *worker); // counts as progress
// A picture of that shape for the frame; NULL when there is no memory for it.
struct picture *worker_make_picture(struct worker *worker, struct assignment_frame *frame, struct error *error);
// Destroys it, but keeps its image for the next one while frames are in hand: the system would have to clear as much anew.
void worker_return_picture(struct worker *worker, struct picture *picture);
void worker_set_ready(struct worker *worker);
void worker_exit(struct worker *worker, int exit_code); // gives waiting frames back, finishes the started ones
void worker_abandon(struct worker *worker, int exit_code);
bool worker_is_unwanted(struct worker *worker, const struct assignment_frame *frame); // dropped or abandoned
void worker_end_frame(struct worker *worker, struct assignment_frame *frame);
void worker_drop_frame(struct worker *worker, struct assignment_frame *frame); // ends it and gives it back
void worker_end_thread(struct worker *worker);                                 // the last thing a thread does
