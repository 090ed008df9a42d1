// The text of a job file, with the changes of --set applied.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct job;

// Reads `path` ("-" is standard input), applies each PATH=VALUE of `sets` and resolves the job's input files
// (job_inputs.h). Returns compact JSON on one line, owned by the caller, or NULL; the message names the file.
char *job_document_load(const char *path, const char *const sets[], size_t set_count, struct error *error);
// Reads the document as a job. Absolute output paths must lie below `output_root` ("/" for any); a missing input file
// is an error. The message names the file.
bool job_document_check(const char *path, const char *document, const char *output_root, struct job *job,
                        struct error *error);
// The name of `path` in messages.
const char *job_document_name(const char *path);
