// The last look at a frame's file before anyone may see it.
#pragma once

#include "core/publish.h"

#include <stdbool.h>

struct error;
struct job;

struct gate_params {
    int fd;
    const struct job *job;    // borrowed for the call
    const char *picture_hash; // of the job and of what the frame's files hold
    int32_t frame;
    int thread_count; // that read; 0: one
};

// Reads the file back: EXR, this job's size and channels, the picture's hash in the header, frame number, every value finite, and that
// cut rays took no larger share of its light than the job allows, where it has such. On success
// `file` (may be NULL) says inode, size and hash.
bool gate_check(const struct gate_params *params, struct published_file *file, struct error *error);
