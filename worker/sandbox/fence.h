// What a worker that serves one job may reach, as the message worker.fence has it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/path_list.h"

#include <stdbool.h>
#include <stddef.h>

struct error;
struct message;

// As struct job_input of core/job/input_roots.h.
struct fence_input {
    char *place, *root, *folder, *path; // owned
};

// The zero value is empty.
struct fence {
    struct fence_input *inputs; // owned
    size_t input_count, input_capacity;
    char *output_root;       // owned; absolute
    char *output_folder;     // owned; relative to it, "" for the root itself
    struct path_list closed; // places of the daemon's, which may not be inside a folder that is opened
    bool has_converter;      // nanovdb_convert is run
};

bool fence_read(struct fence *fence, const struct message *message, struct error *error);
void fence_finish(struct fence *fence);
