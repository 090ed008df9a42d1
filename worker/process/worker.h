// The state that a worker's threads share: one reads orders, one renders and answers, one encodes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/picture/ray_counts.h"
#include "worker/plan/plan.h"
#include "worker/process/assignment.h"
#include "worker/process/connection.h"
#include "worker/process/live_preview.h"
#include "worker/process/report.h"
#include "worker/sandbox/sandbox.h"

#include <limits.h>
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
    int folder_fd; // owned; the folder of its file
    double world_to_camera[16], world_to_ndc[16];
    double render_s;
    enum job_method method; // the job's, or the one chosen in its place
    double paths;           // random ones of each pixel that was traced, of all its samples; 0: no such method
    double step;            // in metres; likewise
    struct ray_counts ray_counts;
    double traced;                        // as in struct frame_accuracy
    struct audit_result audit;            // AUDIT_NONE: the job states no tolerance
    double sampling_error;                // relative RMSE by the number of samples per pixel; 0: not measured
    struct job_beyond beyond;             // not known: not written
    int64_t plan_number;                  // 0: none
    double weight;                        // as in struct tolerance_result
    char quality[IMAGE_EXR_QUALITY_SIZE]; // the plan's settings in this frame; empty: none
    char plan[PLAN_REASON_SIZE];          // the plan's reason, or the draft's; empty: the job names its method
    char shader_hash[64];
    char hash[HASH_TEXT_SIZE]; // of the job and of the contents of the frame's input files
};

void picture_destroy(struct picture *picture); // accepts NULL

struct worker {
    const struct options *options; // borrowed; outlives us
    struct connection connection;
    int wake_fd;                     // readable once a thread has ended
    atomic_ullong progress;          // grows with every step of rendering or encoding
    char host[HOST_NAME_MAX + 1];    // of this machine; set before there are threads
    char backend[16];                // set before the first frame, then constant
    char renderer[128];              // likewise
    char sandbox[SANDBOX_TEXT_SIZE]; // likewise; what the sandbox restricts

    struct live_preview preview;

    pthread_mutex_t lock; // guards what follows
    pthread_cond_t changed;
    struct assignment assignment;
    struct request *requests; // owned; oldest first
    struct report_doing doing;
    struct picture *rendered; // owned; waits for the encoder; meanwhile no other frame is started
    struct image spare;       // owned; the image of the next picture; empty while no frame is assigned
    bool is_ready;            // worker.ready is sent
    bool is_exiting;          // takes no new frames; finishes started ones
    bool is_abandoned;        // nobody listens: everything is dropped at once
    bool has_renderer_ended;  // the encoder ends once no picture waits
    int running_threads;
    int exit_code;
};

bool worker_init(struct worker *worker, const struct options *options);
void worker_finish(struct worker *worker); // after its threads have ended

void worker_advance(struct worker *worker); // counts as progress
// A picture for the frame, of its size and channels; NULL when there is no memory.
struct picture *worker_make_picture(struct worker *worker, struct assignment_frame *frame, struct error *error);
// Destroys the picture, but keeps its image for the next one while frames are assigned: the system would clear new
// memory first.
void worker_return_picture(struct worker *worker, struct picture *picture);
void worker_set_doing(struct worker *worker, const struct report_doing *doing);
void worker_set_ready(struct worker *worker);
void worker_exit(struct worker *worker, int exit_code); // drops waiting frames, finishes started ones
void worker_abandon(struct worker *worker, int exit_code);
bool worker_is_unwanted(struct worker *worker, const struct assignment_frame *frame); // dropped or abandoned
void worker_end_frame(struct worker *worker, struct assignment_frame *frame);
void worker_drop_frame(struct worker *worker, struct assignment_frame *frame); // ends it and reports it as dropped
void worker_end_thread(struct worker *worker);                                 // the last thing a thread does
