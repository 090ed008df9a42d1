// What the modelled orders of scattering leave out, by the plans of a daemon's job.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job_beyond.h"

#include <stddef.h>
#include <stdint.h>

struct connection;

// The zero value is empty.
struct plan_beyond {
    struct plan_beyond_of {
        int64_t number; // of the plan
        struct job_beyond beyond;
    } * list; // owned; plans that know it
    size_t count;
};

// Asks for the newest plans of a job. Empty where none knows it, and where the daemon does not answer: the next call
// says why.
void plan_beyond_ask(struct plan_beyond *plans, struct connection *connection, int64_t job);
// NULL: unknown.
const struct job_beyond *plan_beyond_find(const struct plan_beyond *plans, int64_t number);
void plan_beyond_finish(struct plan_beyond *plans);
