// Which pictures of an older version of a job a new one would replace.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct job_files;
struct job_table;

// Whether a job that is no draft, and whose pictures have another hash than `hash`, has published some of `files`, as
// far as the table knows: they may be gone.
bool output_older_is_likely(const struct job_table *table, const struct job_files *files, const char *hash);
// The frames of `files` whose files are in the folder, in no order; owned by the caller. `folder` stays open. Legal in
// any thread.
int32_t *output_older_list(const struct job_files *files, int folder, size_t *count);
// True when none of these frames was published last by a job with another hash. Else `error` names the first of them,
// the job, and what to do.
bool output_older_check(const struct job_table *table, const struct job_files *files, const char *hash,
                        const int32_t *frames, size_t count, struct error *error);
