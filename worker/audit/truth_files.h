// The input files of a frame, whole in memory for reference/: grids, temperatures, textures, a dome.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/still.h"
#include "worker/volume/file_hashes.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct job;

// A file whose contents `inputs` hold.
struct truth_file {
    char *path; // owned; NULL: none
    struct file_version version;
    int64_t size_bytes; // in memory
};

// The zero value holds nothing.
struct truth_files {
    struct still_inputs inputs; // owned, except `functions`, which this module never touches
    struct truth_file media[SCENE_MEDIUM_LIMIT], textures[SCENE_OBJECT_LIMIT], dome;
};

// Loads the files of frame `frame`. Files of the same job that are already held are read again only if their path or
// contents differ. Refuses more than half of the memory that this process may have, because GL keeps a copy. On failure
// nothing is held.
bool truth_files_load(struct truth_files *files, const struct job *job, int32_t frame, struct error *error);
void truth_files_finish(struct truth_files *files); // accepts an empty one
