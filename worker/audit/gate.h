// The last look at a frame's file before anyone may see it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/publish.h"
#include "worker/picture/image_exr.h"

#include <stdbool.h>

struct error;
struct job;

struct gate_params {
    int fd;
    const struct job *job;    // borrowed for the call
    const char *picture_hash; // of the job and of what the frame's files hold
    int32_t frame;
    int thread_count; // that read; 0: one
    double tolerance; // in place of the job's and of the one that the header claims; 0: none is
};

struct gate_result {
    struct image_exr_facts facts; // once the header could be read, even of a file that is refused; else zero
    struct published_file file;   // of a file that passed: inode, size and hash
};

// Reads the file back: EXR, this job's size and channels, the picture's hash in the header, frame number, every value finite,
// that cut rays took no larger share of its light than the job allows, where it has such, and that its error was measured,
// where the job states a tolerance. A measured error is within the tolerance: the job's and the one that the header claims.
// It is the estimate that is held to it, as when a frame is rendered again; its 95 % bound has only to be there.
// `result` may be NULL.
bool gate_check(const struct gate_params *params, struct gate_result *result, struct error *error);

// The part of it that is about a measured error. `job_tolerance` is 0 where the job states none, `given_tolerance`
// as struct gate_params has it.
bool gate_check_audit(const struct audit_result *audit, double job_tolerance, double given_tolerance,
                      struct error *error);
