// Which jobs a list has: by state, owner, name and the time of their submission.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct job_record;
struct request;

// The zero value has no job.
struct job_filter {
    unsigned states;          // bits 1 << enum job_state
    char *owner, *name;       // owned; NULL: any. `name`, in small letters, is a part of a job's.
    double since_s, before_s; // unix time of the submission: from the first on, and before the second
    bool has_since, has_before;
};

// Reads the members `state`, `owner`, `name`, `since` and `before` of the params. On failure code and error of the
// request are filled. To be finished in both cases.
bool job_filter_read(struct job_filter *filter, struct request *request);
void job_filter_finish(struct job_filter *filter);
bool job_filter_has(const struct job_filter *filter, const struct job_record *record);
bool job_filter_has_all(const struct job_filter *filter); // every job there may be
