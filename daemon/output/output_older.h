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

// Frames whose files are there, and the look at who published them. The zero value has none.
struct output_older {
    const struct job_files *files; // borrowed; of the new job, with its hash
    const char *hash;
    bool is_unknown; // no job of the table has published others than such with this hash
    int32_t *frames; // owned; in no order
    size_t count;
    size_t next;     // where the next step begins
    size_t replaced; // of those before it: published last by a job with another hash
    int32_t first;   // the lowest of these
    int64_t job;     // which published it
    char *name;      // owned; of that job
    // By the headers of those that were looked into:
    size_t seen;        // of other jobs or versions, drafts apart
    int32_t first_seen; // the lowest of these
};

// Begins a look for a new job's files and hash, which are borrowed.
void output_older_begin(struct output_older *older, const struct job_table *table, const struct job_files *files,
                        const char *hash);
// Finds the frames of older->files whose files are in the folder, which stays open, and looks into 64 of these at most,
// evenly chosen: who deleted a job, or rendered without a farm, left pictures that the table does not know. Legal in
// any thread.
void output_older_list(struct output_older *older, int folder);
// Looks at some of these frames, for a millisecond at the most; true: there are more. Jobs may come and go between.
bool output_older_step(struct output_older *older, const struct job_table *table);
// After the last step: true when none is replaced. Else `error` names the first of them, what made it, and what to do.
bool output_older_check(const struct output_older *older, struct error *error);
void output_older_finish(struct output_older *older);
