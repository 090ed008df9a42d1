// The files that a worker for one job may access, from the message worker.fence.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/path_list.h"

#include <stdbool.h>
#include <stddef.h>

struct error;
struct message;

// The fields are those of struct job_input in core/job/input_roots.h.
struct fence_input {
    char *place, *root, *folder, *path; // owned
};

// The zero value is empty.
struct fence {
    struct fence_input *inputs; // owned
    size_t input_count, input_capacity;
    char *output_root;       // owned; absolute
    char *output_folder;     // owned; relative to the root, "" for the root itself
    struct path_list closed; // the daemon's own paths, which no opened folder may contain
    bool has_converter;      // the job runs nanovdb_convert
};

bool fence_read(struct fence *fence, const struct message *message, struct error *error);
void fence_finish(struct fence *fence);
