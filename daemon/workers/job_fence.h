// What a job's worker may reach: the message worker.fence, from the job's document and the daemon's options.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct farm;
struct job_record;
struct json_writer;

// False when the document cannot be read, or reads what is below no input root any more; `*is_job_fault` tells which.
bool job_fence_write(const struct farm *farm, const struct job_record *record, struct json_writer *writer,
                     bool *is_job_fault, struct error *error);
