// The message worker.fence: the files that a job's worker may reach, from the job's document and the daemon's options.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct farm;
struct job_record;
struct json_writer;

// False when the store cannot read the document (`*is_job_fault` is false), or when the document is invalid or names a
// file below no input root (it is true).
bool job_fence_write(const struct farm *farm, const struct job_record *record, struct json_writer *writer,
                     bool *is_job_fault, struct error *error);
