// Why the queued frames of a job wait, as one of a few classes; job_view says it in words.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct farm;
struct job_record;

enum job_wait {
    JOB_WAIT_NONE,   // it has no frame to render, or is over
    JOB_WAIT_SERVED, // others of its frames are being rendered
    JOB_WAIT_TURN,   // ready workers may render it, and are with other jobs
    JOB_WAIT_WORKER, // no worker that may render it is ready
    JOB_WAIT_POOL,   // it asks for a pool that its owner may not use, or that there is not
    JOB_WAIT_OUTPUT, // whether its output can be written is looked at
    JOB_WAIT_ROOT,   // its output root is not there
    JOB_WAIT_PAUSED,
    JOB_WAIT_JOBS, // it comes after others
    JOB_WAIT_DRAINED,
    JOB_WAIT_STORE, // the store takes nothing
    JOB_WAIT_COUNT
};

extern const char *const job_wait_names[JOB_WAIT_COUNT];

// What holds for all jobs at one moment.
struct job_wait_scene {
    const struct farm *farm; // borrowed
    uint64_t pools, ready;   // bits of the pools that there are, and of those with a ready worker
};

struct job_wait_scene job_wait_look(const struct farm *farm);
enum job_wait job_wait_find(const struct job_wait_scene *scene, const struct job_record *record);
// Seconds since a frame of the job ran, or since it was submitted, within this run of the daemon.
double job_wait_seconds(const struct job_wait_scene *scene, const struct job_record *record, int64_t clock_ms);
