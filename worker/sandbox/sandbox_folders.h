// The folders and files of one job, opened below their roots, and what of them a sandbox lets through.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

// Files of a job that are opened one by one, 50 us each: a worker that does not start in time is killed.
enum { SANDBOX_FILE_LIMIT = 32768 };

struct error;
struct fence;
struct fence_input;
struct sandbox_landlock;

// The folder that the input's file is in, so that files beside it are read too and one may be replaced by another: unless
// that is the root itself, or holds a place that is closed. Then the files alone that are there now and have its name.
// Nothing that is in a closed place is opened. Links inside the root are followed. One that leads out of it, and a folder
// that is not there, are errors, and so are more files that are opened one by one than `*files_left`, which gets less.
bool sandbox_folders_allow_input(const struct sandbox_landlock *landlock, const struct fence *fence,
                                 const struct fence_input *input, size_t *files_left, struct error *error);
// The output folder, made if it is missing. One that holds a closed place is an error.
bool sandbox_folders_allow_output(const struct sandbox_landlock *landlock, const struct fence *fence,
                                  struct error *error);
