// Removes what a job published: of its files those alone that still are what it published. Blocking.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct frame_range;
struct output_path;

struct file_remover {
    const char *state_folder; // all borrowed
    int64_t job;
    const char *root;
    const struct output_path *path;
    const struct frame_range *frames;
    int64_t finished_ms;    // unix time; what was written later is somebody else's
    bool may_remove_folder; // if it is empty then
    int64_t removed, kept;  // files: results, also after a failure
    int64_t removed_bytes;
};

// On success what is gone is gone durably. A file that is not there any more is neither removed nor kept.
bool file_remover_run(struct file_remover *remover, struct error *error);
