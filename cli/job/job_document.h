// A job file as the user gave it, with the changes of --set applied.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct job;

// Reads `path` ("-" is standard input), applies each PATH=VALUE of `sets` and resolves the files that it reads (job_inputs.h).
// Compact JSON on one line, owned by the caller; NULL on failure, with the file named.
char *job_document_load(const char *path, const char *const sets[], size_t set_count, struct error *error);
// Reads the document as a job; absolute output paths must lie below `output_root` ("/" for any). A file that it reads and
// that is not there is an error. Names the file.
bool job_document_check(const char *path, const char *document, const char *output_root, struct job *job,
                        struct error *error);
// The name of `path` in messages.
const char *job_document_name(const char *path);
