// Reads a job document (docs/job_format.md).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"

#include <stdbool.h>
#include <stddef.h>

struct job;

enum { JOB_DOCUMENT_LIMIT = 4 * 1000 * 1000 }; // bytes of a job file; less than MESSAGE_LINE_LIMIT

// `document` is the job object; places in messages start there ("frames: ..."). An absolute output.path must lie below
// `output_root` (absolute; NULL: no absolute path is allowed). On failure `job` is empty.
bool job_from_json(struct job *job, const struct json_node *document, const char *output_root, struct error *error);
bool job_parse(struct job *job, const char *text, size_t length, const char *output_root, struct error *error);
