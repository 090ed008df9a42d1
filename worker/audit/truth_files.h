// The files that a frame reads, whole in memory as reference/ wants them: grids, temperatures, textures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/still.h"
#include "worker/volume/file_hashes.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct job;

// A file that `inputs` hold something of.
struct truth_file {
    char *path; // owned; NULL: nothing is held
    struct file_version version;
    int64_t size_bytes; // in memory
};

// The zero value holds nothing.
struct truth_files {
    struct still_inputs inputs; // owned, but for `functions`, which nothing here touches
    struct truth_file media[SCENE_MEDIUM_LIMIT], textures[SCENE_OBJECT_LIMIT];
};

// Makes it the files of frame `frame`. What is held of the same job already is read again only where its file is another
// one or changed. More than half of the memory that this process may hope for is refused: GL has a copy as well.
// On failure nothing is held.
bool truth_files_load(struct truth_files *files, const struct job *job, int32_t frame, struct error *error);
void truth_files_finish(struct truth_files *files); // accepts an empty one
