// Part files that workers of an earlier daemon left when they or it were killed: a whole one is taken for its frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/output_path.h"

#include <stdbool.h>
#include <stddef.h>

struct gate_result;
struct job;

// Of one job. The zero value is not listed yet.
struct old_parts {
    struct output_part *list; // owned; their farm is borrowed
    size_t count, capacity;
    bool is_listed;
};

void old_parts_finish(struct old_parts *parts);

// All borrowed for the call, but the farm's id for the life of the list.
struct old_parts_params {
    const struct job *job;
    const struct output_part *own; // the attempt: epochs before its own are earlier
    const char *picture_hash;      // that the file's header must have
    int folder_fd;                 // the job's folder
};

// Gives a part file of the frame that passes the gate the name of the attempt, synced. `found` is what the gate read.
// False where none does.
bool old_parts_take(struct old_parts *parts, const struct old_parts_params *params, struct gate_result *found);
