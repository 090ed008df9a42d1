// The last check of a frame's file before it is published.
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
    const char *picture_hash; // hash of the job and of the contents of the frame's input files
    int32_t frame;
    int thread_count;    // threads that read; 0: one
    double tolerance;    // replaces the job's and the header's; 0: neither is replaced
    bool accepts_missed; // a frame over its tolerance passes if its header says that and the job publishes such frames
};

struct gate_result {
    struct image_exr_facts facts; // set once the header is read, even if the file is refused; else zero
    struct published_file file;   // inode, size and hash of a file that passed
};

// Reads the file back and checks that it is an EXR file of this job's size and channels, that its header has the
// picture's hash and the frame's number, and that every value is finite. In scenes with paths, the share of light that
// cut rays may have cost is within max_cut. If the job states a tolerance, the error has been measured and is within
// the tolerance, both the job's and the one that the header claims, unless accepts_missed. The estimate counts, as when
// a frame is rendered again; error95 has only to be finite. `result` may be NULL.
bool gate_check(const struct gate_params *params, struct gate_result *result, struct error *error);

struct gate_tolerance {
    double job;   // 0: it states none
    double given; // as in gate_params
    bool accepts_missed;
};

// Checks the measured error alone.
bool gate_check_audit(const struct audit_result *audit, const struct gate_tolerance *tolerance, struct error *error);
