// The files that a worker for the jobs of one owner may access, from the message worker.fence.
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

struct fence_job {
    struct fence_input *inputs; // owned
    size_t input_count, input_capacity;
    char *output_root;   // owned; absolute
    char *root_id;       // owned; of its marker; NULL: its folder is not checked
    char *output_folder; // owned; relative to the root, "" for the root itself
};

// The zero value is empty.
struct fence {
    struct fence_job job;     // the job that the worker is started for
    struct fence_job *others; // owned; of the same owner
    size_t other_count, other_capacity;
    struct path_list closed; // the daemon's own paths, which no opened folder may contain
    bool has_converter;      // the job runs nanovdb_convert
};

bool fence_read(struct fence *fence, const struct message *message, struct error *error);
void fence_finish(struct fence *fence);
