// The jobs that a job comes after. No picture depends on them, and no hash has them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct json_node;

enum { JOB_AFTER_LIMIT = 64 };

// The zero value is empty.
struct job_after {
    int64_t *ids; // owned; none twice
    size_t count;
    bool takes_any_end; // it is enough that they are over; else they must have succeeded
};

// Reads the job's `after`, which may be absent. Finish in both cases.
bool job_after_from_json(struct job_after *after, const struct json_node *document, struct error *error);
struct job_after job_after_take(struct job_after *after); // leaves it empty
void job_after_finish(struct job_after *after);           // accepts an empty one
