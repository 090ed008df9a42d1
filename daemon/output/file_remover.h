// Removes the files that a job published, unless they were replaced or changed since. Blocking.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct frame_range;
struct output_path;

struct file_remover {
    const char *state_folder; // pointers are borrowed
    int64_t job;
    const char *root, *root_id;
    const struct output_path *path;
    const struct frame_range *frames;
    int64_t finished_ms;    // unix time; a file written later is not removed
    bool may_remove_folder; // when it is empty after the removal
    // Results: counts of files, also valid after a failure.
    int64_t removed;
    int64_t kept;    // replaced or changed since, or of a frame whose retry was canceled or failed
    int64_t missing; // moved or removed by others
    int64_t removed_bytes;
};

// On success the removals are on disk. A root that is not there is an error: its files are elsewhere.
bool file_remover_run(struct file_remover *remover, struct error *error);
