// Opens the folders and files of one job below their roots and allows them in the sandbox.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

// The most files of a job that are opened one by one, 50 us each: a worker that starts too slowly is killed.
enum { SANDBOX_FILE_LIMIT = 32768 };

struct error;
struct fence;
struct fence_input;
struct fence_job;
struct sandbox_landlock;

// Allows the folder of the input's file, so that files beside it can be read and a file can be replaced. Where the
// folder is the root itself, or contains a closed path, only the files are allowed that are there now and match the
// input's name. Nothing inside a closed path is allowed. Links inside the root are followed. A link that leads out of
// it, a folder that does not exist, and more single files than `*files_left`, which counts down, are errors.
bool sandbox_folders_allow_input(const struct sandbox_landlock *landlock, const struct fence *fence,
                                 const struct fence_input *input, size_t *files_left, struct error *error);
// Allows the job's output folder, and reading the marker of its root, by which a frame knows later that the root is
// still there. A folder that contains a closed path is an error. `*is_root_away` (may be NULL): the root is not there.
bool sandbox_folders_allow_output(const struct sandbox_landlock *landlock, const struct fence *fence,
                                  const struct fence_job *job, bool *is_root_away, struct error *error);
